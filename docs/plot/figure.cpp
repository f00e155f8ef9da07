#include "docs/plot/figure.h"

#include "docs/plot/table.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>

namespace tf::plot {

namespace {

std::vector<std::string> splitWords(const std::string &line) {
  std::vector<std::string> words;
  bool quoted = false, inWord = false;
  for (const char c : line) {
    if (c == '#' && !quoted) {
      break;
    }
    if (c == '"') {
      quoted = !quoted;
      if (quoted) {
        words.emplace_back();
      }
      inWord = quoted;
    } else if (c == ' ' && !quoted) {
      inWord = false;
    } else {
      if (!inWord) {
        words.emplace_back();
      }
      inWord = true;
      words.back() += c;
    }
  }
  return words;
}

class Reader {
public:
  explicit Reader(std::string folder) : folder_(std::move(folder)) {}

  void readLine(const std::vector<std::string> &words) {
    words_ = &words;
    const std::string &key = words[0];
    if (key == "title") {
      figure_.title = word(1);
    } else if (key == "size") {
      figure_.width = value(1);
      figure_.height = value(2);
    } else if (key == "columns") {
      figure_.columns = static_cast<int>(value(1));
    } else if (key == "panel") {
      figure_.panels.push_back({.title = word(1)});
    } else if (figure_.panels.empty()) {
      throw std::runtime_error("'" + key + "' needs a panel");
    } else {
      readPanel(key);
    }
  }

  [[nodiscard]] Figure take() { return std::move(figure_); }

private:
  [[nodiscard]] const std::string &word(std::size_t i) const {
    if (i >= words_->size()) {
      throw std::runtime_error("'" + words_->front() + "' needs more words");
    }
    return (*words_)[i];
  }
  [[nodiscard]] double value(std::size_t i) const { return std::stod(word(i)); }
  [[nodiscard]] std::string optionalWord(std::size_t i) const { return i < words_->size() ? (*words_)[i] : std::string(); }

  const Table &table(const std::string &file) {
    auto &entry = tables_[file];
    if (!entry) {
      entry = std::make_unique<Table>(folder_ + "/" + file);
    }
    return *entry;
  }

  void readPanel(const std::string &key) {
    Panel &panel = figure_.panels.back();
    if (key == "x" || key == "y") {
      Axis &axis = key == "x" ? panel.x : panel.y;
      axis.isLogarithmic = word(1) == "log";
      axis.label = word(axis.isLogarithmic ? 2 : 1);
    } else if (key == "range") {
      (word(1) == "x" ? panel.x : panel.y).range = std::pair(value(2), value(3));
    } else if (key == "equal") {
      panel.isEqual = true;
    } else if (key == "line" || key == "points" || key == "dashed") {
      addCurve(panel, key == "line" ? Style::Line : key == "points" ? Style::Points : Style::Dashed);
    } else if (key == "outline") {
      addOutlines(panel);
    } else if (key == "horizontal" || key == "vertical") {
      const auto kind = key == "horizontal" ? Marker::Kind::Horizontal : Marker::Kind::Vertical;
      panel.markers.push_back({.kind = kind, .value = value(1), .label = optionalWord(2)});
    } else if (key == "band") {
      panel.markers.push_back({.kind = Marker::Kind::Band, .value = value(1), .end = value(2), .label = optionalWord(3)});
    } else {
      throw std::runtime_error("'" + key + "' is not known");
    }
  }

  void addCurve(Panel &panel, Style style) {
    const Table &data = table(word(1));
    const auto &x = data.column(word(2)), &y = data.column(word(3));
    Curve curve{.style = style, .label = optionalWord(4)};
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::isfinite(x[i]) && std::isfinite(y[i])) {
        curve.points.emplace_back(x[i], y[i]);
      }
    }
    panel.curves.push_back(std::move(curve));
  }

  // A word is a column or, at a fixed place, a number.
  [[nodiscard]] double coordinate(const Table &data, std::size_t i, std::size_t row) const {
    char *end = nullptr;
    const double number = std::strtod(word(i).c_str(), &end);
    return *end == '\0' ? number : data.column(word(i))[row];
  }

  void addOutlines(Panel &panel) {
    const Table &data = table(word(1));
    const double step = value(2);
    const auto &time = data.column("time");
    double next = 0;
    for (std::size_t row = 0; row < time.size(); ++row) {
      if (time[row] < next - 1e-9) {
        continue;
      }
      next += step;
      Curve curve{.style = Style::Outline, .shade = 0.25 + 0.75 * time[row] / time.back()};
      for (std::size_t i = 3; i + 1 < words_->size(); i += 2) {
        curve.points.emplace_back(coordinate(data, i, row), coordinate(data, i + 1, row));
      }
      panel.curves.push_back(std::move(curve));
    }
  }

  Figure figure_;
  std::string folder_;
  std::map<std::string, std::unique_ptr<Table>> tables_;
  const std::vector<std::string> *words_ = nullptr;
};

}  // namespace

Figure readFigure(const std::string &path, const std::string &dataFolder) {
  std::ifstream file(path);
  if (!file) {
    throw std::runtime_error("cannot read '" + path + "'");
  }
  Reader reader(dataFolder);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string> words = splitWords(line);
    if (words.empty()) {
      continue;
    }
    try {
      reader.readLine(words);
    } catch (const std::exception &error) {
      throw std::runtime_error(path + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  return reader.take();
}

}  // namespace tf::plot
