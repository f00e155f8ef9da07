#include "docs/plot/figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace tf::plot {

namespace {

// A palette that stays distinguishable for colour-blind readers (Okabe and Ito).
constexpr std::array kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"};
constexpr const char *kInk = "#24292f", *kGrid = "#e4e7eb", *kMuted = "#6b7480";

std::string escape(const std::string &text) {
  std::string out;
  for (const char c : text) {
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return out;
}

struct Rectangle {
  double left = 0, top = 0, width = 0, height = 0;
};

// Data values to pixels along one axis.
struct Scale {
  double low = 0, high = 1, from = 0, to = 1;
  bool isLogarithmic = false;

  [[nodiscard]] double transform(double value) const { return isLogarithmic ? std::log10(value) : value; }
  [[nodiscard]] double pixel(double value) const { return from + (transform(value) - low) / (high - low) * (to - from); }
};

std::vector<double> ticks(const Scale &scale, int wanted) {
  std::vector<double> values;
  if (scale.isLogarithmic) {
    const int stride = std::max(1, static_cast<int>(std::ceil((scale.high - scale.low) / wanted)));
    for (int e = static_cast<int>(std::ceil(scale.low - 1e-9)); e <= scale.high + 1e-9; e += stride) {
      values.push_back(std::pow(10.0, e));
    }
    return values;
  }
  const double raw = (scale.high - scale.low) / wanted, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double mantissa = raw / power;
  const double step = power * (mantissa <= 1 ? 1 : mantissa <= 2 ? 2 : mantissa <= 5 ? 5 : 10);
  for (double t = std::ceil(scale.low / step - 1e-9) * step; t <= scale.high + 1e-9 * step; t += step) {
    values.push_back(std::abs(t) < 1e-9 * step ? 0 : t);
  }
  return values;
}

std::string tickLabel(double value, bool isLogarithmic) {
  if (isLogarithmic) {
    return fmt::format("10<tspan dy=\"-4\" font-size=\"8.5\">{}</tspan>", static_cast<int>(std::lround(std::log10(value))));
  }
  const std::string text = fmt::format("{:.6g}", value);
  return text.starts_with('-') ? "\u2212" + text.substr(1) : text;
}

class PanelWriter {
public:
  PanelWriter(const Panel &panel, int number, Rectangle box, std::string &out) : panel_(panel), number_(number), out_(out) {
    const std::string &yLabel = panel.y.label;
    box_ = {box.left + (yLabel.empty() ? 46 : 62), box.top + (panel.title.empty() ? 10 : 30), box.width - (yLabel.empty() ? 60 : 76),
            box.height - (panel.title.empty() ? 10 : 30) - (panel.x.label.empty() ? 26 : 44)};
    x_ = scaleOf(panel.x, true);
    y_ = scaleOf(panel.y, false);
    if (panel.isEqual) {
      equalise();
    }
  }

  void write() {
    bands();
    frame();
    lines();
    add("<clipPath id=\"c{0}\"><rect x=\"{1:.1f}\" y=\"{2:.1f}\" width=\"{3:.1f}\" height=\"{4:.1f}\"/></clipPath><g "
        "clip-path=\"url(#c{0})\">\n",
        number_, box_.left, box_.top - 2, box_.width + 2, box_.height + 2);
    int colour = 0;
    for (const Curve &curve : panel_.curves) {
      writeCurve(
          curve,
          kColours[static_cast<std::size_t>(curve.style == Style::Line || curve.style == Style::Points ? colour++ : 0) % kColours.size()]);
    }
    out_ += "</g>\n";
    legend();
  }

private:
  template <class... Args> void add(fmt::format_string<Args...> format, Args &&...args) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
  }

  [[nodiscard]] Scale scaleOf(const Axis &axis, bool isX) const {
    Scale scale{.isLogarithmic = axis.isLogarithmic};
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Curve &curve : panel_.curves) {
      for (const auto &[px, py] : curve.points) {
        const double value = scale.transform(isX ? px : py);
        if (std::isfinite(value)) {
          low = std::min(low, value);
          high = std::max(high, value);
        }
      }
    }
    if (axis.range) {
      low = scale.transform(axis.range->first);
      high = scale.transform(axis.range->second);
    } else if (!(high > low)) {
      low = std::isfinite(low) ? low - 0.5 : 0;
      high = low + 1;
    } else if (!isX || axis.isLogarithmic) {
      const double margin = 0.06 * (high - low);
      low -= margin;
      high += margin;
    }
    scale.low = low;
    scale.high = high;
    scale.from = isX ? box_.left : box_.top + box_.height;
    scale.to = isX ? box_.left + box_.width : box_.top;
    return scale;
  }

  // Widens the range of one axis so that a unit is as long on both.
  void equalise() {
    const double perX = (x_.high - x_.low) / box_.width, perY = (y_.high - y_.low) / box_.height;
    Scale &scale = perX < perY ? x_ : y_;
    const double length = perX < perY ? perY * box_.width : perX * box_.height;
    const double middle = (scale.low + scale.high) / 2;
    scale.low = middle - length / 2;
    scale.high = middle + length / 2;
  }

  void frame() {
    const double right = box_.left + box_.width, bottom = box_.top + box_.height;
    for (const double t : ticks(x_, std::max(2, static_cast<int>(box_.width / 70)))) {
      const double p = x_.pixel(t);
      add("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"{3}\"/>\n", p, box_.top, bottom, kGrid);
      add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" class=\"t\">{}</text>\n", p, bottom + 16, tickLabel(t, x_.isLogarithmic));
    }
    for (const double t : ticks(y_, std::max(2, static_cast<int>(box_.height / 38)))) {
      const double p = y_.pixel(t);
      add("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"{}\"/>\n", box_.left, p, right, kGrid);
      add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" class=\"t\">{}</text>\n", box_.left - 7, p + 4,
          tickLabel(t, y_.isLogarithmic));
    }
    add("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}H{3:.1f}\" fill=\"none\" stroke=\"{4}\"/>\n", box_.left, box_.top, bottom, right, kMuted);
    if (!panel_.title.empty()) {
      add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"h\">{}</text>\n", box_.left, box_.top - 10, escape(panel_.title));
    }
    if (!panel_.x.label.empty()) {
      add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" class=\"l\">{}</text>\n", box_.left + box_.width / 2, bottom + 35,
          escape(panel_.x.label));
    }
    if (!panel_.y.label.empty()) {
      const double px = box_.left - 44, py = box_.top + box_.height / 2;
      add("<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\" class=\"l\">{}</text>\n", px, py,
          escape(panel_.y.label));
    }
  }

  void bands() {
    for (const Marker &marker : panel_.markers) {
      if (marker.kind == Marker::Kind::Band) {
        const double from = x_.pixel(marker.value), to = x_.pixel(marker.end);
        add("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#fdf1d8\"/>\n", from, box_.top, to - from,
            box_.height);
        add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" class=\"t\">{}</text>\n", (from + to) / 2, box_.top + 13,
            escape(marker.label));
      }
    }
  }

  void lines() {
    for (const Marker &marker : panel_.markers) {
      if (marker.kind == Marker::Kind::Horizontal) {
        const double p = y_.pixel(marker.value);
        add("<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"{}\" stroke-width=\"1.2\"/>\n", box_.left, p, box_.width, kMuted);
        add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" class=\"t\">{}</text>\n", box_.left + box_.width - 4, p - 5,
            escape(marker.label));
      } else if (marker.kind == Marker::Kind::Vertical) {
        const double p = x_.pixel(marker.value);
        add("<path d=\"M{:.1f} {:.1f}v{:.1f}\" stroke=\"{}\" stroke-dasharray=\"2 3\"/>\n", p, box_.top, box_.height, kMuted);
        add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"t\">{}</text>\n", p + 4, box_.top + 11, escape(marker.label));
      }
    }
  }

  void writeCurve(const Curve &curve, const char *colour) {
    std::string path;
    double lastX = 0, lastY = 0;
    bool isFirst = true;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const double px = x_.pixel(curve.points[i].first), py = y_.pixel(curve.points[i].second);
      if (!std::isfinite(px) || !std::isfinite(py)) {
        continue;
      }
      // Points closer than half a pixel are left out; the last one never is.
      if (!isFirst && i + 1 < curve.points.size() && std::abs(px - lastX) + std::abs(py - lastY) < 0.5) {
        continue;
      }
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", isFirst ? "M" : "L", px, py);
      if (curve.style == Style::Points) {
        add("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", px, py, colour);
      }
      isFirst = false;
      lastX = px;
      lastY = py;
    }
    switch (curve.style) {
    case Style::Line:
      add("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" stroke-linejoin=\"round\"/>\n", path, colour);
      break;
    case Style::Points:
      add("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\"/>\n", path, colour);
      break;
    case Style::Dashed:
      add("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\" stroke-dasharray=\"5 4\"/>\n", path, kMuted);
      break;
    case Style::Outline:
      add("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.4\" stroke-linejoin=\"round\" stroke-opacity=\"{:.2f}\"/>\n", path,
          colour, curve.shade);
      break;
    }
  }

  // In the corner that the curves leave most free.
  void legend() {
    std::vector<const Curve *> named;
    std::size_t longest = 0;
    for (const Curve &curve : panel_.curves) {
      if (!curve.label.empty()) {
        named.push_back(&curve);
        longest = std::max(longest, curve.label.size());
      }
    }
    if (named.empty()) {
      return;
    }
    const double width = 36 + 6.6 * static_cast<double>(longest), height = 8 + 17 * static_cast<double>(named.size());
    const Rectangle place = freestCorner(width, height);
    add("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"3\" fill=\"#ffffff\" fill-opacity=\"0.85\"/>\n",
        place.left, place.top, width, height);
    std::size_t colour = 0;
    double y = place.top + 13;
    for (const Curve &curve : panel_.curves) {
      const bool isGrey = curve.style == Style::Dashed;
      const char *stroke = isGrey ? kMuted : curve.style == Style::Outline ? kColours[0] : kColours[colour++ % kColours.size()];
      if (curve.label.empty()) {
        continue;
      }
      add("<path d=\"M{:.1f} {:.1f}h20\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", place.left + 5, y, stroke,
          isGrey ? " stroke-dasharray=\"5 4\"" : "");
      add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"l\">{}</text>\n", place.left + 31, y + 4, escape(curve.label));
      y += 17;
    }
  }

  [[nodiscard]] Rectangle freestCorner(double width, double height) const {
    const double right = box_.left + box_.width - width - 5, bottom = box_.top + box_.height - height - 5;
    const std::array corners = {Rectangle{right, box_.top + 5, width, height}, Rectangle{box_.left + 6, box_.top + 5, width, height},
                                Rectangle{right, bottom, width, height}, Rectangle{box_.left + 6, bottom, width, height}};
    const auto covered = [&](const Rectangle &r) {
      double sum = 0;
      for (const Curve &curve : panel_.curves) {
        int hits = 0;
        for (const auto &[vx, vy] : curve.points) {
          const double px = x_.pixel(vx), py = y_.pixel(vy);
          hits += px > r.left && px < r.left + r.width && py > r.top && py < r.top + r.height;
        }
        sum += static_cast<double>(hits) / static_cast<double>(std::max<std::size_t>(1, curve.points.size()));
      }
      return sum;
    };
    return *std::ranges::min_element(corners, {}, covered);
  }

  const Panel &panel_;
  int number_;  // in the figure
  std::string &out_;
  Rectangle box_;
  Scale x_, y_;
};

}  // namespace

std::string toSvg(const Figure &figure) {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<style>text{{font-family:Inter,'Helvetica Neue',Helvetica,Arial,'DejaVu Sans',sans-serif;fill:{2}}}"
      ".t{{font-size:11px;fill:{3}}}.l{{font-size:12px}}.h{{font-size:13px;font-weight:600}}.H{{font-size:15px;font-weight:600}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      figure.width, figure.height, kInk, kMuted);
  const double top = figure.title.empty() ? 6 : 38;
  if (!figure.title.empty()) {
    out += fmt::format("<text x=\"{}\" y=\"26\" text-anchor=\"middle\" class=\"H\">{}</text>\n", figure.width / 2, escape(figure.title));
  }
  const int columns = std::max(1, figure.columns), rows = (static_cast<int>(figure.panels.size()) + columns - 1) / columns;
  const double width = figure.width / columns, height = (figure.height - top) / std::max(1, rows);
  for (int i = 0; i < static_cast<int>(figure.panels.size()); ++i) {
    const Rectangle box{width * (i % columns), top + height * (i / columns), width, height};
    PanelWriter(figure.panels[static_cast<std::size_t>(i)], i, box, out).write();
  }
  return out + "</svg>\n";
}

}  // namespace tf::plot
