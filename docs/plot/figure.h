// A figure: panels with curves, described by a small text file.
//
//   title TEXT                          above all panels
//   size WIDTH HEIGHT                   of the whole, in pixels
//   columns N                           panels per row
//   panel TEXT                          begins a panel
//   x [log] TEXT        y [log] TEXT    labels of its axes
//   range x|y LOW HIGH                  instead of the data's range
//   equal                               same scale on both axes
//   line FILE XCOLUMN YCOLUMN [LABEL]   a curve; also `points` (markers joined by a thin line) and `dashed` (grey)
//   outline FILE STEP X1 Y1 X2 Y2 …     a polygon through the points of every row whose time is a multiple of STEP; numbers are fixed
//   horizontal VALUE [LABEL]            a line across; also `vertical`, and `band LOW HIGH [LABEL]`, a shaded range of x
//
// Words with spaces stand in double quotes; `#` begins a comment. Files are relative to the description's data folder.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tf::plot {

enum class Style { Line, Points, Dashed, Outline };

struct Curve {
  Style style = Style::Line;
  std::vector<std::pair<double, double>> points = {};
  std::string label = {};
  double shade = 1;  // opacity of an outline
};

struct Marker {
  enum class Kind { Horizontal, Vertical, Band } kind = Kind::Horizontal;
  double value = 0, end = 0;  // end: of a band
  std::string label = {};
};

struct Axis {
  std::string label = {};
  bool isLogarithmic = false;
  std::optional<std::pair<double, double>> range = {};
};

struct Panel {
  std::string title = {};
  Axis x = {}, y = {};
  bool isEqual = false;
  std::vector<Curve> curves = {};
  std::vector<Marker> markers = {};
};

struct Figure {
  std::string title = {};
  double width = 900, height = 420;
  int columns = 1;
  std::vector<Panel> panels;
};

// Reads a description; throws std::runtime_error with the line's number.
[[nodiscard]] Figure readFigure(const std::string &path, const std::string &dataFolder);

// The figure as a self-contained SVG file.
[[nodiscard]] std::string toSvg(const Figure &figure);

}  // namespace tf::plot
