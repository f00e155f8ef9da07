// Compile time (source text to code in memory) of generated models of growing size, per 1 000 scalar expression nodes of the derived system
// and relative to the smallest one: 1 where the time is linear in the size.
#include "compiler/codegen/codegen.h"
#include "compiler/mechanics/hybrid_system.h"
#include "lang/semantics/instantiate.h"
#include "tests/benchmarks/measurement.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace tf::bench {

namespace {

// Coupled first-order equations, written out.
std::string reactions(int size) {
  std::string text = "model Generated\n  parameter Real k = 0.3;\n";
  for (int i = 1; i <= size; ++i) {
    text += fmt::format("  Real x{}(start = {}, fixed = true);\n", i, 0.1 * (i % 7));
  }
  text += "equation\n";
  for (int i = 1; i <= size; ++i) {
    const int next = i % size + 1;
    text += fmt::format("  der(x{0}) = k*(x{1} - x{0}) + sin(x{0} + {0}*0.01)*exp(-x{1}^2) - x{0}/(1 + x{1}^2);\n", i, next);
  }
  return text + "end Generated;\n";
}

// A row of masses between non-linear springs.
std::string oscillators(int size) {
  return fmt::format(R"(model Generated
  parameter Real k = 10, d = 0.1;
  coordinate Real x[{0}];
  body mass[{0}](each mass = 1, position = x);
  force spring[{0} - 1](value = -k*sinh(x[2:{0}] - x[1:{0} - 1]) - d*(der(x[2:{0}]) - der(x[1:{0} - 1])), at = x[2:{0}] - x[1:{0} - 1]);
end Generated;
)",
                     size);
}

// A chain of links with absolute angles: its mass matrix is full; written out, it would grow with the square of the number of links.
std::string chain(int size) {
  return fmt::format(R"(model Generated
  parameter Real l = 0.1, m = 0.2, g = 9.81;
  coordinate Real phi[{0}](start = fill(0.1, {0}));
  Real node[{0} + 1, 2];
  body rod[{0}](each mass = m, position = (node[1:{0}, :] + node[2:{0} + 1, :])/2, angle = phi, each inertia = m*l^2/12);
  gravity weight(acceleration = {{0, -g}});
equation
  node[1, :] = {{0, 0}};
  for i in 1:{0} loop
    node[i + 1, :] = node[i, :] + l*{{cos(phi[i]), sin(phi[i])}};
  end for;
end Generated;
)",
                     size);
}

// All pairs of the numbers 1 … size, as lists of the first and of the second ones.
struct Pairs {
  std::string first, second;
  int count = 0;
};

Pairs pairsOf(int size) {
  Pairs pairs;
  for (int i = 1; i <= size; ++i) {
    for (int j = i + 1; j <= size; ++j, ++pairs.count) {
      pairs.first += fmt::format("{}{}", pairs.count == 0 ? "" : ", ", i);
      pairs.second += fmt::format("{}{}", pairs.count == 0 ? "" : ", ", j);
    }
  }
  return pairs;
}

// Spheres any two of which may touch, with slips of two components between them: each contact moves the twelve velocities of two bodies.
std::string roughSpheres(int size) {
  const auto [first, second, pairs] = pairsOf(size);
  return fmt::format(R"(model Generated
  parameter Real m = 0.5, r = 0.05, mu = 0.3;
  parameter Integer a[{1}] = {{{2}}}, b[{1}] = {{{3}}};
  coordinate Real p[{0}, 3](start = {{{{0.2*i, 0, 0}} for i in 1:{0}}});
  coordinate Rotation Q[{0}];
  Real w[{0}, 3] = {{Q[i]*Q[i].w for i in 1:{0}}};
  body ball[{0}](each mass = m, position = p, orientation = Q, each inertia = 2/5*m*r^2*identity(3));
  Real d[{1}, 3] = {{p[b[k], :] - p[a[k], :] for k in 1:{1}}};
  Real n[{1}, 3] = {{d[k, :]/sqrt(d[k, :]*d[k, :]) for k in 1:{1}}};
  Real h[{1}, 3] = {{cross({{0.1, 0.2, 1}}, n[k, :]) for k in 1:{1}}};
  Real t[{1}, 3] = {{h[k, :]/sqrt(h[k, :]*h[k, :]) for k in 1:{1}}};
  Real v[{1}, 3] = {{der(p[b[k], :]) - der(p[a[k], :]) - r*cross(w[a[k], :] + w[b[k], :], n[k, :]) for k in 1:{1}}};
  contact pair[{1}](gap = {{sqrt(d[k, :]*d[k, :]) - 2*r for k in 1:{1}}},
                    slip = {{{{t[k, :]*v[k, :], cross(n[k, :], t[k, :])*v[k, :]}} for k in 1:{1}}}, each friction = mu);
end Generated;
)",
                     size, pairs, first, second);
}

// Discs any two of which may touch, with floor and walls: all contacts of a kind are alike.
std::string discs(int size) {
  const auto [first, second, pairs] = pairsOf(size);
  return fmt::format(R"(model Generated
  parameter Real R = 0.1, mu = 0.3, e = 0.2, W = 0.8;
  parameter Integer a[{1}] = {{{2}}}, b[{1}] = {{{3}}};
  coordinate Real r[{0}, 2](start = {{{{0.25*i, 0.3}} for i in 1:{0}}});
  coordinate Real phi[{0}];
  body disc[{0}](each mass = 0.1, position = r, angle = phi, each inertia = 0.05*R^2);
  gravity weight(acceleration = {{0, -9.81}});
  contact floor[{0}](gap = {{r[i, 2] - R for i in 1:{0}}}, slip = {{der(r[i, 1]) + R*der(phi[i]) for i in 1:{0}}}, each friction = mu,
                     each restitution = e);
  contact wall[{0}](gap = {{r[i, 1] + W - R for i in 1:{0}}}, slip = {{der(r[i, 2]) - R*der(phi[i]) for i in 1:{0}}}, each friction = mu);
  Real d[{1}, 2] = {{r[b[k], :] - r[a[k], :] for k in 1:{1}}};
  Real l[{1}] = {{sqrt(d[k, :]*d[k, :]) for k in 1:{1}}};
  contact pair[{1}](gap = {{l[k] - 2*R for k in 1:{1}}},
                    slip = {{(d[k, 1]*(der(r[b[k], 2]) - der(r[a[k], 2])) - d[k, 2]*(der(r[b[k], 1]) - der(r[a[k], 1])))/l[k] -
                             R*(der(phi[a[k]]) + der(phi[b[k]])) for k in 1:{1}}}, each friction = mu, each restitution = e);
end Generated;
)",
                     size, pairs, first, second);
}

// Nodes that the system's own expressions reach, before any derivatives for integrators.
int countNodes(const HybridSystem &system) {
  std::vector<ir::NodeId> open;
  const auto add = [&](const std::vector<ir::NodeId> &ids) { open.insert(open.end(), ids.begin(), ids.end()); };
  add(system.mass);
  add(system.force);
  add(system.stateDerivatives);
  add(system.outputs);
  for (const Contact &contact : system.contacts) {
    add({contact.gap, contact.gapRate, contact.bias});
  }
  for (const TangentRow &tangent : system.tangents) {
    add({tangent.slip, tangent.bias});
  }
  std::vector<bool> seen(static_cast<std::size_t>(system.graph.size()));
  int count = 0;
  while (!open.empty()) {
    const ir::NodeId id = open.back();
    open.pop_back();
    if (id < 0 || seen[static_cast<std::size_t>(id)]) {
      continue;
    }
    seen[static_cast<std::size_t>(id)] = true;
    ++count;
    const ir::Node &node = system.graph[id];
    open.insert(open.end(), node.operands, node.operands + node.arity);
  }
  return count;
}

struct Compilation {
  double frontEnd = 0, derivation = 0, code = 0;  // CPU seconds
  int nodes = 0;
  [[nodiscard]] double total() const { return frontEnd + derivation + code; }
};

Compilation compile(const std::string &path, CodeGenerator &generator) {
  Compilation result;
  SourceManager sources;
  Diagnostics diagnostics;
  double start = cpuSeconds();
  const auto lap = [&start] {
    const double now = cpuSeconds(), elapsed = now - start;
    start = now;
    return elapsed;
  };
  const Instantiation instantiation = instantiate(sources, {path}, {}, diagnostics);
  result.frontEnd = lap();
  if (!instantiation.model) {
    throw std::runtime_error("the generated model is wrong:\n" + render(diagnostics, sources));
  }
  auto system = derive(*instantiation.model, sources, diagnostics);
  result.derivation = lap();
  if (!system) {
    throw std::runtime_error("the generated model cannot be derived:\n" + render(diagnostics, sources));
  }
  result.nodes = countNodes(*system);
  lap();
  const auto compiled = generator.compileInMemory(*system, sources, {});
  result.code = lap();
  return result;
}

using Generate = std::string (*)(int);

void measureFamily(const Setup &setup, CodeGenerator &generator, const std::string &name, Generate generate, std::vector<int> sizes,
                   std::vector<Measurement> &out) {
  double smallest = 0, perThousand = 0;
  Compilation last;
  std::string growth;
  for (const int size : sizes) {
    const std::string path = fmt::format("{}/{}.tf", setup.work, size);
    std::ofstream(path) << generate(size);
    last = compile(path, generator);
    perThousand = 1e6 * last.total() / last.nodes;
    smallest = smallest == 0 ? perThousand : smallest;
    growth += fmt::format("{}{}: {:.0f}", growth.empty() ? "ms/1000 at " : ", ", size, perThousand);
  }
  out.push_back({.name = fmt::format("compile time, {} {}", sizes.back(), name),
                 .unit = "ms/1000",
                 .value = perThousand,
                 .note = fmt::format("{} nodes; front end {:.0f} ms, derivation {:.0f} ms, code {:.0f} ms", last.nodes, 1e3 * last.frontEnd,
                                     1e3 * last.derivation, 1e3 * last.code)});
  out.push_back({.name = fmt::format("growth per node, {} to {} {}", sizes.front(), sizes.back(), name),
                 .unit = "ratio",
                 .value = perThousand / smallest,
                 .bar = 1.5,
                 .note = growth});
}

}  // namespace

std::vector<Measurement> compileTime(const Setup &setup) {
  CodeGenerator &generator = *tf_make_code_generator();
  const std::string warmUp = setup.work + "/warm.tf";
  std::ofstream(warmUp) << reactions(2);
  (void)compile(warmUp, generator);
  std::vector<Measurement> out;
  measureFamily(setup, generator, "first-order equations", reactions, {50, 100, 200, 400}, out);
  measureFamily(setup, generator, "oscillators", oscillators, {25, 50, 100}, out);
  measureFamily(setup, generator, "links of a chain", chain, {8, 16, 32, 64, 128}, out);
  measureFamily(setup, generator, "rough spheres", roughSpheres, {4, 8, 16}, out);
  measureFamily(setup, generator, "discs", discs, {10, 20, 40}, out);
  return out;
}

}  // namespace tf::bench
