#include "runtime/results/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <system_error>

namespace tf::runtime {

namespace {

struct Field {
  std::string text;
  std::size_t line = 0, column = 0;  // of its first byte, from 1
  bool quoted = false;
};

using Row = std::vector<Field>;

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos)
    return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

// Splits the text into rows of fields, RFC 4180 section 2.
class Scanner {
public:
  Scanner(std::string_view text, const std::string &fileName) : text_(text), fileName_(fileName) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF")
      text_.remove_prefix(3);
  }

  [[nodiscard]] Failure failure(std::size_t line, std::size_t column, const std::string &message) const {
    return {fmt::format("{}:{}:{}: {}", fileName_, line, column, message)};
  }
  [[nodiscard]] Failure failure(const Field &field, const std::string &message) const { return failure(field.line, field.column, message); }

  // The next row that is not blank; no fields at the end of the text.
  Outcome<Row> next() {
    while (position_ < text_.size()) {
      Row row;
      bool more = true;
      while (more) {
        Field field;
        if (auto scanned = scanField(field); !scanned)
          return Failure{scanned.error()};
        row.push_back(std::move(field));
        more = position_ < text_.size() && text_[position_] == ',';
        if (more)
          ++position_;
      }
      endLine();
      if (row.size() > 1 || row[0].quoted || !row[0].text.empty())
        return row;
    }
    return Row{};
  }

private:
  [[nodiscard]] bool atLineEnd() const { return position_ == text_.size() || text_[position_] == '\n' || text_[position_] == '\r'; }
  [[nodiscard]] std::size_t column() const { return position_ - lineStart_ + 1; }

  void endLine() {
    if (position_ < text_.size())
      position_ += text_.substr(position_, 2) == "\r\n" ? 2 : 1;
    ++line_;
    lineStart_ = position_;
  }

  void skipBlanks() {
    while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t'))
      ++position_;
  }

  Outcome<void> scanField(Field &field) {
    skipBlanks();
    field.line = line_;
    field.column = column();
    if (position_ < text_.size() && text_[position_] == '"')
      return scanQuoted(field);
    const std::size_t first = position_;
    while (!atLineEnd() && text_[position_] != ',')
      ++position_;
    field.text = trimmed(text_.substr(first, position_ - first));
    return {};
  }

  Outcome<void> scanQuoted(Field &field) {
    field.quoted = true;
    for (++position_; position_ < text_.size(); ++position_) {
      const char c = text_[position_];
      if (c == '"' && text_.substr(position_, 2) != "\"\"")
        break;
      position_ += c == '"' ? 1 : 0;
      field.text += c;
      if (c == '\n') {
        ++line_;
        lineStart_ = position_ + 1;
      }
    }
    if (position_ == text_.size())
      return failure(field, "this quoted field does not end");
    ++position_;
    skipBlanks();
    if (!atLineEnd() && text_[position_] != ',')
      return failure(line_, column(), fmt::format("expected a comma after the quoted field, found '{}'", text_[position_]));
    return {};
  }

  std::string_view text_;
  const std::string &fileName_;
  std::size_t position_ = 0, line_ = 1, lineStart_ = 0;
};

// What a column of the file is.
struct Column {
  std::int32_t variable = -1;  // -1: time
  std::int32_t table = -1;     // among the tables that are read
  double sign = 1;
};

class Reader {
public:
  Reader(std::string_view text, const std::string &fileName, const ModelInstance &instance)
      : scanner_(text, fileName), fileName_(fileName), instance_(instance) {}

  Outcome<std::vector<InputTable>> read() {
    auto header = scanner_.next();
    if (!header)
      return Failure{header.error()};
    if (header.value().empty())
      return Failure{fmt::format("{}: the file is empty: a header row with 'time' and names of inputs was expected", fileName_)};
    if (auto done = readHeader(header.value()); !done)
      return Failure{done.error()};
    for (;;) {
      const auto row = scanner_.next();
      if (!row)
        return Failure{row.error()};
      if (row.value().empty())
        break;
      if (auto done = readRow(row.value()); !done)
        return Failure{done.error()};
    }
    if (times_.empty())
      return Failure{fmt::format("{}: the file has a header but no rows", fileName_)};
    for (InputTable &table : tables_)
      table.times = times_;
    return std::move(tables_);
  }

private:
  Outcome<void> readHeader(const Row &header) {
    header_ = header;
    for (std::size_t i = 0; i < header.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        if (header[j].text == header[i].text)
          return scanner_.failure(header[i], fmt::format("column '{}' occurs twice", header[i].text));
      if (header[i].text == "time") {
        columns_.push_back({});
        continue;
      }
      if (auto added = addInput(header[i]); !added)
        return added;
    }
    if (!hasTime())
      return scanner_.failure(header[0], noTime());
    if (tables_.empty())
      return scanner_.failure(header[0], "there is no column of an input");
    return {};
  }

  Outcome<void> addInput(const Field &field) {
    if (field.text.empty())
      return scanner_.failure(field, "this column has no name");
    const auto reference = instance_.find(field.text);
    if (!reference)
      return scanner_.failure(field, notAnInput(field.text));
    const tf_variable &variable = instance_.model().variables[reference->variable];
    if (variable.kind != TF_KIND_INPUT)
      return scanner_.failure(field, fmt::format("'{}' is not an input of model '{}'", field.text, instance_.model().name));
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (columns_[i].variable == reference->variable)
        return scanner_.failure(field, fmt::format("'{}' and '{}' are the same input", header_[i].text, field.text));
    columns_.push_back({reference->variable, static_cast<std::int32_t>(tables_.size()), reference->sign});
    tables_.push_back({variable.index, {}, {}});
    return {};
  }

  [[nodiscard]] std::string notAnInput(const std::string &name) const {
    double number = 0;
    if (parseNumber(name, number))
      return fmt::format("a header row with 'time' and names of inputs was expected, found the number {}", name);
    if (name.find(';') != std::string::npos)
      return fmt::format("fields must be separated by commas, found '{}'", name);
    return hasTime() ? instance_.unknownName(name, TF_KIND_INPUT) : noTime();
  }

  [[nodiscard]] bool hasTime() const {
    return std::any_of(header_.begin(), header_.end(), [](const Field &field) { return field.text == "time"; });
  }
  [[nodiscard]] std::string noTime() const { return fmt::format("there is no column 'time'; the header row is {}", written(header_)); }

  Outcome<void> readRow(const Row &row) {
    if (row.size() != columns_.size())
      return scanner_.failure(
          row.back(), fmt::format("this row has {} field{}, the header has {}", row.size(), row.size() == 1 ? "" : "s", columns_.size()));
    for (std::size_t i = 0; i < row.size(); ++i) {
      double value = 0;
      const bool isBoolean = columns_[i].variable >= 0 && (instance_.model().variables[columns_[i].variable].flags & TF_BOOLEAN) != 0;
      if (!(isBoolean && parseBoolean(row[i].text, value)) && !parseNumber(row[i].text, value))
        return scanner_.failure(row[i], fmt::format("column '{}' needs {}, found {}", header_[i].text,
                                                    isBoolean ? "true or false" : "a number", quote(row[i].text)));
      if (!std::isfinite(value))
        return scanner_.failure(row[i], fmt::format("column '{}' needs a finite number, found {}", header_[i].text, row[i].text));
      if (auto added = columns_[i].variable < 0 ? addTime(row[i], value) : addValue(row[i], columns_[i], value); !added)
        return added;
    }
    return {};
  }

  Outcome<void> addTime(const Field &field, double time) {
    if (!times_.empty() && time < times_.back())
      return scanner_.failure(field, fmt::format("times must not decrease: {} comes after {}", time, times_.back()));
    times_.push_back(time);
    return {};
  }

  Outcome<void> addValue(const Field &field, const Column &column, double value) {
    const double own = column.sign * value;
    if (auto checked = instance_.checkValue(column.variable, own, instance_.model().variables[column.variable].name); !checked)
      return scanner_.failure(field, checked.error());
    tables_[static_cast<std::size_t>(column.table)].values.push_back(own);
    return {};
  }

  static std::string quote(const std::string &text) { return text.empty() ? "nothing" : "'" + text + "'"; }

  static std::string written(const Row &header) {
    std::string names;
    for (const Field &field : header)
      names += (names.empty() ? "" : ", ") + quote(field.text);
    return names;
  }

  // As the language, spreadsheets and Python write them.
  static bool parseBoolean(std::string_view text, double &value) {
    const bool isTrue = text == "true" || text == "TRUE" || text == "True";
    value = isTrue ? 1 : 0;
    return isTrue || text == "false" || text == "FALSE" || text == "False";
  }

  // The whole field as a decimal number; a leading plus is allowed.
  static bool parseNumber(std::string_view text, double &value) {
    if (!text.empty() && text.front() == '+')
      text.remove_prefix(text.size() > 1 && text[1] == '-' ? 0 : 1);
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ptr != text.data() + text.size() || text.empty())
      return false;
    if (result.ec == std::errc::result_out_of_range)  // from_chars leaves the value alone
      value = underflows(text) ? 0 : HUGE_VAL;
    return result.ec == std::errc() || result.ec == std::errc::result_out_of_range;
  }

  static bool underflows(std::string_view text) {
    const std::size_t exponent = text.find_first_of("eE");
    return exponent == std::string_view::npos ? text.find_first_of("123456789") > text.find('.') : text.substr(exponent + 1, 1) == "-";
  }

  Scanner scanner_;
  const std::string &fileName_;
  const ModelInstance &instance_;
  Row header_;
  std::vector<Column> columns_;
  std::vector<InputTable> tables_;
  std::vector<double> times_;
};

Outcome<std::string> fileContents(const std::string &path) {
  const auto failure = [&] { return Failure{fmt::format("cannot read '{}': {}", path, std::generic_category().message(errno))}; };
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (file == nullptr)
    return failure();
  std::string text;
  char block[1 << 16];
  for (std::size_t read = 0; (read = std::fread(block, 1, sizeof block, file.get())) > 0;)
    text.append(block, read);
  if (std::ferror(file.get()) != 0)
    return failure();
  return text;
}

}  // namespace

Outcome<std::vector<InputTable>> parseInputTables(std::string_view text, const std::string &fileName, const ModelInstance &instance) {
  if (text.substr(0, 2) == "\xFF\xFE" || text.substr(0, 2) == "\xFE\xFF")
    return Failure{fmt::format("{}: the file is UTF-16 text; save it as UTF-8", fileName)};
  return Reader(text, fileName, instance).read();
}

Outcome<std::vector<InputTable>> readInputTables(const std::string &path, const ModelInstance &instance) {
  const auto text = fileContents(path);
  if (!text)
    return Failure{text.error()};
  return parseInputTables(text.value(), path, instance);
}

}  // namespace tf::runtime
