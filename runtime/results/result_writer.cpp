#include "runtime/results/result_writer.h"

#include "runtime/results/output_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace tf::runtime {

namespace {

// RFC 4180 ends lines with CR LF.
constexpr std::string_view lineEnd = "\r\n";

double valueOf(const ResultColumn &column, std::span<const double> values) {
  return column.sign * values[static_cast<std::size_t>(column.variable)];
}

class CsvWriter : public ResultWriter {
public:
  CsvWriter(OutputFile file, std::vector<ResultColumn> columns)
      : file_(std::move(file)), columns_(std::move(columns)), fields_(columns_.size()) {}

  // An error stays with the file: the first row reports it.
  void writeHeader() {
    line_.clear();
    for (const ResultColumn &column : columns_) {
      if (!line_.empty())
        line_ += ',';
      appendCsvField(line_, column.name);
    }
    line_ += lineEnd;
    static_cast<void>(file_.write(line_));
  }

  Outcome<void> writeRow(std::span<const double> values) override {
    std::swap(line_, lastLine_);
    line_.clear();
    for (std::size_t i = 0; i < columns_.size();) {
      const std::size_t first = i, begin = line_.size();
      while (i < columns_.size() && isRepeated(fields_[i], valueOf(columns_[i], values)))
        ++i;
      if (i > first) {
        line_.append(lastLine_, fields_[first].begin, fields_[i - 1].end - fields_[first].begin);
        const std::size_t shift = begin - fields_[first].begin;  // downwards, too
        for (std::size_t k = first; k < i; ++k) {
          fields_[k].begin += shift;
          fields_[k].end += shift;
        }
      } else {
        const double value = valueOf(columns_[i], values);
        appendNumber(line_, value);
        fields_[i++] = {value, begin, line_.size()};
      }
      line_ += ',';
    }
    line_.replace(line_.size() - 1, 1, lineEnd);
    return file_.write(line_);
  }

  Outcome<void> finish() override { return file_.close(); }

private:
  // A value of the last row and its place in that: most numbers of the two rows at an event are the same, and copied.
  struct Field {
    double value = 0;
    std::size_t begin = 0, end = 0;
  };

  static bool isRepeated(const Field &last, double value) {
    return last.end > last.begin && std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(last.value);
  }

  OutputFile file_;
  std::vector<ResultColumn> columns_;
  std::vector<Field> fields_;
  std::string line_, lastLine_;
};

void appendJsonString(std::string &text, std::string_view value) {
  constexpr char hexDigits[] = "0123456789abcdef";
  text += '"';
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (byte < 0x20) {
      text += "\\u00";
      text += hexDigits[byte >> 4];
      text += hexDigits[byte & 15];
    } else {
      text += c;
    }
  }
  text += '"';
}

// {"model": NAME, "variables": [{"name", "unit", "description"}, ...], "data": {NAME: [values], ...}}. JSON has no infinities and NaN: they
// are the strings that CSV has for them.
class JsonWriter : public ResultWriter {
public:
  JsonWriter(OutputFile file, const tf_model &model, std::vector<ResultColumn> columns)
      : file_(std::move(file)), model_(&model), columns_(std::move(columns)), data_(columns_.size()) {}
  ~JsonWriter() override { static_cast<void>(end()); }
  JsonWriter(const JsonWriter &) = delete;
  JsonWriter &operator=(const JsonWriter &) = delete;

  Outcome<void> writeRow(std::span<const double> values) override {
    for (std::size_t i = 0; i < columns_.size(); ++i)
      data_[i].push_back(valueOf(columns_[i], values));
    return {};
  }

  Outcome<void> finish() override { return end(); }

private:
  Outcome<void> end() {
    if (!finished_) {
      finished_ = true;
      std::string text;
      appendVariables(text);
      static_cast<void>(file_.write(text));  // errors stay with the file
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        text = i == 0 ? "\n    " : ",\n    ";
        appendColumn(text, i);
        static_cast<void>(file_.write(text));
      }
      static_cast<void>(file_.write("\n  }\n}\n"));
    }
    return file_.close();
  }

  void appendVariables(std::string &text) const {
    text += "{\n  \"model\": ";
    appendJsonString(text, model_->name);
    text += ",\n  \"variables\": [";
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const ResultColumn &column = columns_[i];
      text += i == 0 ? "\n    {\"name\": " : ",\n    {\"name\": ";
      appendJsonString(text, column.name);
      text += ", \"unit\": ";
      appendJsonString(text, column.unit);
      text += ", \"description\": ";
      appendJsonString(text, column.description);
      text += '}';
    }
    text += "\n  ],\n  \"data\": {";
  }

  void appendColumn(std::string &text, std::size_t column) const {
    appendJsonString(text, columns_[column].name);
    text += ": [";
    for (const double value : data_[column]) {
      const bool finite = std::isfinite(value);
      text += finite ? "" : "\"";
      appendNumber(text, value);
      text += finite ? ", " : "\", ";
    }
    if (!data_[column].empty())
      text.resize(text.size() - 2);
    text += ']';
  }

  OutputFile file_;
  const tf_model *model_;
  std::vector<ResultColumn> columns_;
  std::vector<std::vector<double>> data_;
  bool finished_ = false;
};

enum class Format : std::uint8_t { Unknown, Csv, Json };

Format formatOf(const std::string &path) {
  std::string suffix = path.substr(std::min(path.size(), path.find_last_of("./")));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return suffix == ".csv" ? Format::Csv : suffix == ".json" ? Format::Json : Format::Unknown;
}

}  // namespace

Outcome<std::unique_ptr<ResultWriter>> ResultWriter::create(const std::string &path, const tf_model &model,
                                                            std::vector<ResultColumn> columns) {
  const Format format = formatOf(path);
  if (format == Format::Unknown)
    return Failure{"cannot write results to '" + path + "': the name must end in .csv or .json"};
  if (columns.empty())
    return Failure{"cannot write results to '" + path + "': no variables were chosen"};
  auto file = OutputFile::create(path);
  if (!file)
    return Failure{file.error()};
  if (format == Format::Json)
    return std::unique_ptr<ResultWriter>(std::make_unique<JsonWriter>(std::move(file.value()), model, std::move(columns)));
  auto writer = std::make_unique<CsvWriter>(std::move(file.value()), std::move(columns));
  writer->writeHeader();
  return std::unique_ptr<ResultWriter>(std::move(writer));
}

std::vector<ResultColumn> visibleColumns(const tf_model &model) {
  std::vector<ResultColumn> columns;
  const auto isVisible = [&](std::int32_t variable) { return (model.variables[variable].flags & TF_PROTECTED) == 0; };
  for (std::int32_t i = 0; i < model.variable_count; ++i)
    if (isVisible(i))
      columns.push_back({i, 1, model.variables[i].name, model.variables[i].description, model.variables[i].unit});
  for (std::int32_t i = 0; i < model.alias_count; ++i) {
    const tf_alias &alias = model.aliases[i];
    const char *description = *alias.description != '\0' ? alias.description : model.variables[alias.variable].description;
    if (isVisible(alias.variable))
      columns.push_back({alias.variable, alias.sign, alias.name, description, model.variables[alias.variable].unit});
  }
  return columns;
}

}  // namespace tf::runtime
