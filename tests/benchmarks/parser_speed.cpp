// Throughput of lexer and parser: over all .mo and .tf files of a folder, or over a generated source of a few megabytes.
#include "lang/syntax/parser.h"
#include "tests/benchmarks/measurement.h"

#include <filesystem>
#include <fmt/format.h>
#include <stdexcept>

namespace tf::bench {

namespace {

std::string generatedSource(int classes) {
  std::string text = "within ;\npackage Generated \"classes as they occur in libraries\"\n";
  for (int i = 0; i < classes; ++i) {
    text += fmt::format(R"(
  model Drive{0} "motor, gear and load number {0}"
    extends Base.Interfaces.TwoFlanges(final useSupport = false, redeclare replaceable package Medium = Base.Media.Air);
    parameter Modelica.Units.SI.Inertia J(min = 0, start = 1.0e-3) = {0}.5e-4 "moment of inertia" annotation(Dialog(group = "Load"));
    parameter Real ratio[3, 3] = {{{{1, 0, 0}}, {{0, cos(alpha), -sin(alpha)}}, {{0, sin(alpha), cos(alpha)}}}};
    Base.Blocks.Sine sine(amplitude = 2*Modelica.Constants.pi*f, each offset = if time < 1 then 0 else -k[end]);
    Real w(start = 0, fixed = true, stateSelect = StateSelect.prefer), phi, tau[n - 1];
  equation
    // Newton's law, and what the gear transmits
    phi = flange_a.phi + integer(time)*2;
    J*der(w) = flange_a.tau + ratio[1, :]*tau[1:3] - d*abs(w)^2.5*sign(w);
    for i in 1:n - 1 loop
      tau[i] = c*(phi[i + 1] - phi[i]) + (if initial() then 0 else d*(der(phi[i + 1]) - der(phi[i])));
    end for;
    when {{sample(0, Ts), edge(reset)}} then
      reinit(w, pre(w)*0.5);
    end when;
    connect(sine.y, gear[{1}].flange_b) annotation(Line(points = {{{{-10, 0}}, {{12.5, 0}}}}, color = {{0, 0, 127}}));
  end Drive{0};
)",
                        i, i % 7 + 1);
  }
  return text + "end Generated;\n";
}

std::size_t loadFolder(const std::string &folder, SourceManager &sources) {
  std::size_t bytes = 0;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder)) {
    const auto suffix = entry.path().extension();
    if (entry.is_regular_file() && (suffix == ".mo" || suffix == ".tf")) {
      if (const auto file = sources.load(entry.path().string())) {
        bytes += sources.file(*file).text().size();
      }
    }
  }
  if (bytes == 0) {
    throw std::runtime_error("no sources in '" + folder + "'");
  }
  return bytes;
}

}  // namespace

std::vector<Measurement> parserSpeed(const Setup &setup) {
  SourceManager sources;
  std::size_t bytes = 0;
  if (setup.sources.empty()) {
    std::string text = generatedSource(3000);
    bytes = text.size();
    sources.add("generated.mo", std::move(text));
  } else {
    bytes = loadFolder(setup.sources, sources);
  }
  std::size_t diagnosticCount = 0;
  const double seconds = cpuPerCall([&] {
    Diagnostics diagnostics;
    for (FileId file = 0; file < sources.count(); ++file) {
      (void)ast::parseFile(sources, file, diagnostics);
    }
    diagnosticCount = diagnostics.all().size();
  });
  const double megabytes = 1e-6 * static_cast<double>(bytes);
  return {{.name = setup.sources.empty() ? "parser, generated library" : "parser, " + setup.sources,
           .unit = "MB/s",
           .value = megabytes / seconds,
           .bar = 20,
           .atLeast = true,
           .note = fmt::format("{:.1f} MB, {} diagnostics", megabytes, diagnosticCount)}};
}

}  // namespace tf::bench
