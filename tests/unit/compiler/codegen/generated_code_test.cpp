// Generated code against the interpreter ir::evaluate, in memory and as a shared library, at all levels of optimisation.
#include "compiled_fixture.h"

#include "compiler/codegen/code_plan.h"
#include "compiler/ir/sweep.h"
#include "lang/base/trigonometry.h"
#include "tests/unit/compiler/ir/random_graph.h"
#include "tests/unit/compiler/ir/run_sweep.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace tf::codegen::testing {
namespace {

using ir::NodeId;
using ir::Op;
using ir::SymbolKind;

std::uint64_t bitsOf(double value) { return std::bit_cast<std::uint64_t>(value); }

bool same(double a, double b) { return bitsOf(a) == bitsOf(b) || (std::isnan(a) && std::isnan(b)); }

double argument(const Call &call, ir::Symbol symbol) {
  const auto index = static_cast<std::size_t>(symbol.index);
  switch (symbol.kind) {
  case SymbolKind::Time:
    return call.inputs[TF_IN_TIME][0];
  case SymbolKind::StepVariable:
    return call.inputs[TF_IN_ALPHA][index];
  default:
    return call.inputs[TF_IN_Z][index];
  }
}

// Expected outputs by the interpreter.
std::vector<std::vector<double>> interpret(const ir::Function &function, const ir::Graph &graph, const Call &call,
                                           const std::vector<std::uint8_t> &mask) {
  std::vector<std::vector<double>> outputs;
  for (const int size : function.bufferSizes)
    outputs.emplace_back(static_cast<std::size_t>(size), untouched);
  std::vector<NodeId> roots;
  for (const ir::Store &store : function.stores)
    roots.push_back(store.node);
  const auto valueOf = [&](ir::Symbol symbol) { return argument(call, symbol); };
  ir::testing::runSweep(function, graph, valueOf, mask, outputs);
  const auto values = ir::evaluate(graph, roots, valueOf);
  for (std::size_t k = 0; k < roots.size(); ++k) {
    const ir::Store &store = function.stores[k];
    if (store.group < 0 || mask[static_cast<std::size_t>(store.group)] != 0)
      outputs[static_cast<std::size_t>(store.buffer)][static_cast<std::size_t>(store.position)] = values[k];
  }
  for (const ir::Store &addition : function.additions)
    if (addition.group < 0 || mask[static_cast<std::size_t>(addition.group)] != 0)
      outputs[static_cast<std::size_t>(addition.buffer)][static_cast<std::size_t>(addition.position)] +=
          ir::evaluate(graph, std::array{addition.node}, valueOf)[0];
  return outputs;
}

void expectSame(const std::vector<std::vector<double>> &expected, const std::vector<std::vector<double>> &actual, const std::string &what) {
  for (std::size_t b = 0; b < expected.size(); ++b)
    for (std::size_t k = 0; k < expected[b].size(); ++k)
      EXPECT_TRUE(same(expected[b][k], actual[b][k]))
          << what << " out[" << b << "][" << k << "]: " << expected[b][k] << " and " << actual[b][k];
}

struct Compiled {
  HybridSystem system;
  std::vector<ir::Function> functions;
  SourceManager sources;

  [[nodiscard]] ModelSource source() const { return {system, functions, sources}; }
  [[nodiscard]] const ir::Function &function() const { return functions[dynamicsIndex]; }
};

// A random function with `groups` guarded groups of stores among others.
Compiled randomFunction(unsigned seed, int nodes, int groups) {
  ir::testing::RandomGraph random = ir::testing::randomSmoothGraph(seed, 8, nodes);
  ir::Function function{"dynamics", {static_cast<int>(random.nodes.size()), 4}, groups, {}};
  std::mt19937 engine(seed);
  for (std::size_t k = 0; k < random.nodes.size(); ++k)
    if (engine() % 4 == 0)
      function.stores.push_back(
          {0, static_cast<int>(k), random.nodes[k], static_cast<int>(engine() % static_cast<unsigned>(groups + 1)) - 1});
  for (int k = 0; k < 4; ++k)
    function.stores.push_back({1, k, random.nodes[random.nodes.size() - 1 - static_cast<std::size_t>(k)], -1});
  Compiled result;
  result.system.name = "random";
  result.system.nz = 8;
  result.system.graph = std::move(random.graph);
  result.functions = asDynamics(std::move(function));
  return result;
}

// The Jacobian of random functions by a sweep over columns or rows; row k in a random group.
Compiled randomSweep(unsigned seed, int groups) {
  constexpr int n = 8;
  const bool overColumns = seed % 2 == 0;
  Compiled result = randomFunction(seed, seed % 3 == 0 ? 1200 : 120, groups);
  ir::Graph &g = result.system.graph;
  ir::Function &function = result.functions[dynamicsIndex];
  std::mt19937 engine(seed + 100);
  std::vector<NodeId> roots, variables, weights;
  for (int k = 0; k < n; ++k)
    variables.push_back(g.symbol(SymbolKind::State, k));
  const int limit = g.size();
  for (int k = 0; k < 25; ++k) {
    roots.push_back(static_cast<NodeId>(engine() % static_cast<unsigned>(limit)));
    weights.push_back(g.symbol(SymbolKind::Seed, k));
  }
  const std::vector<NodeId> results =
      overColumns
          ? ir::forwardDerivative(g, roots,
                                  [&](ir::Symbol symbol) {
                                    return symbol.kind == SymbolKind::State ? g.symbol(SymbolKind::Seed, symbol.index) : g.constant(0);
                                  })
          : ir::reverseDerivative(g, roots, weights, variables);
  std::vector<ir::MatrixRow> rows;
  for (int k = 0; k < 25; ++k)
    rows.push_back({2, k * n, static_cast<int>(engine() % static_cast<unsigned>(groups + 1)) - 1});
  function.bufferSizes.push_back(25 * n);
  const int seeds = overColumns ? n : 25;
  ir::addSweep(function, results, ir::seedStructure(g, results, seeds), seeds, overColumns ? ir::SweepOver::Columns : ir::SweepOver::Rows,
               rows);
  return result;
}

// `count` pairs of groups, each of which evaluates the same with other constants, symbols and places; the two of a pair have some of it in
// common, and so have some of what is stored always. Every fifth one is of another kind.
Compiled likeGroups(int count) {
  Compiled result;
  result.system.name = "alike";
  result.system.nz = 30;
  ir::Graph &g = result.system.graph;
  ir::Function function{"dynamics", {3 * count, 12 * count, count}, 2 * count, {}};
  const auto state = [&g](int k) { return g.symbol(SymbolKind::State, k % 30); };
  for (int k = 0; k < count; ++k) {
    const NodeId angle = g.add(g.mul(g.constant(0.1 * k + 0.3), state(k)), state(3 * k + 1));
    const NodeId shared = g.mul(g.unary(Op::Sin, angle), k % 5 == 0 ? g.binary(Op::Pow, state(k + 2), g.constant(3)) : state(k + 2));
    function.stores.push_back({0, 3 * k, shared, k});
    function.stores.push_back({0, 3 * k + 1, g.div(g.unary(Op::Cos, angle), g.add(state(k + 8), g.constant(5))), k});
    function.stores.push_back({0, 3 * k + 2, g.mul(shared, g.unary(Op::Exp, state(k + 4))), count + k});
    for (int column = 0; column < 12; ++column)
      function.stores.push_back({1, 12 * k + column, column == k % 12 ? g.mul(shared, angle) : g.constant(0), k});
    function.stores.push_back({2, k, g.unary(Op::Atan, g.mul(state(k + 11), g.constant(k + 0.5))), -1});
  }
  result.functions = asDynamics(std::move(function));
  return result;
}

TEST(Repetitions, EqualTheInterpreterBitForBit) {
  constexpr int count = 25;
  const Compiled compiled = likeGroups(count);
  EXPECT_GE(planCode(compiled.function(), compiled.system.graph, 300).repetitions.size(), 4U);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (const int optimization : {0, 2}) {
    const auto inMemory = compileInMemory(compiled.source(), {optimization, ""});
    const Loaded shared(emit(compiled.source(), EmitKind::SharedLibrary, {optimization, ""}));
    for (int trial = 0; trial < 10; ++trial) {
      Call call(compiled.function());
      for (double &value : call.inputs[TF_IN_Z])
        value = uniform(engine);
      std::vector<std::uint8_t> mask(2 * count);
      for (std::uint8_t &flag : mask)
        flag = trial == 0 ? 1 : trial == 1 ? 0 : engine() % 3 == 0 ? 1 : 0;
      const auto expected = interpret(compiled.function(), compiled.system.graph, call, mask);
      Call again = call;
      call.run(inMemory->model()->dynamics, mask);
      expectSame(expected, call.outputs, "in memory");
      again.run(shared.model()->dynamics, mask);
      expectSame(expected, again.outputs, "shared");
    }
  }
}

// Each place of a matrix gets what a sweep stores there, then what the selected groups add, here whole numbers, in any order.
TEST(Additions, FollowTheSweep) {
  for (const int count : {2, 30}) {  // without and with repetitions
    Compiled compiled;
    compiled.system.name = "additions";
    compiled.system.nz = 8;
    ir::Graph &g = compiled.system.graph;
    ir::Function function{"dynamics", {16}, count, {}};
    std::vector<NodeId> results;
    for (int k = 0; k < 4; ++k)
      results.push_back(g.mul(g.symbol(SymbolKind::Seed, k), g.unary(Op::Floor, g.symbol(SymbolKind::State, k))));
    std::vector<ir::MatrixRow> rows;
    for (int k = 0; k < 4; ++k)
      rows.push_back({0, 4 * k, -1});
    ir::addSweep(function, results, ir::seedStructure(g, results, 4), 4, ir::SweepOver::Columns, rows);
    for (int k = 0; k < count; ++k)
      for (int j = 0; j < 3; ++j) {
        const NodeId product = g.mul(g.unary(Op::Floor, g.symbol(SymbolKind::State, (k + j) % 8)), g.constant(k + 2));
        function.additions.push_back({0, (k * 7 + j * 5) % 16, product, k});
      }
    compiled.functions = asDynamics(std::move(function));
    const auto inMemory = compileInMemory(compiled.source(), {2, ""});
    Call call(compiled.function());
    for (std::size_t k = 0; k < 8; ++k)
      call.inputs[TF_IN_Z][k] = 3.5 * static_cast<double>(k) - 9;
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(count), 1);
    mask[1] = 0;
    const auto expected = interpret(compiled.function(), g, call, mask);
    call.run(inMemory->model()->dynamics, mask);
    for (std::size_t k = 0; k < 16; ++k)
      EXPECT_EQ(call.outputs[0][k], expected[0][k]) << k;
  }
}

// Results along the caller's directions where a mask is given, the matrix where none is.
TEST(Products, EqualTheInterpreterBitForBit) {
  constexpr int n = 8;
  for (const unsigned seed : {1U, 2U, 3U}) {
    Compiled compiled = randomFunction(seed, seed == 3 ? 1200 : 120, 0);
    ir::Graph &g = compiled.system.graph;
    ir::Function &function = compiled.functions[dynamicsIndex];
    const int matrix = static_cast<int>(function.bufferSizes.size());
    std::vector<NodeId> results;
    std::vector<ir::MatrixRow> rows;
    for (int k = 0; k < 20; ++k) {
      const NodeId factor = static_cast<NodeId>((static_cast<unsigned>(k) * 37 + seed) % static_cast<unsigned>(g.size()));
      results.push_back(g.add(g.mul(factor, g.symbol(SymbolKind::Seed, k % n)), g.symbol(SymbolKind::Seed, (k + 3) % n)));
      rows.push_back({matrix, k * n, -1});
    }
    function.bufferSizes.push_back(20 * n);
    function.bufferSizes.push_back(20 * TF_DIRECTIONS);
    ir::addSweep(function, results, ir::seedStructure(g, results, n), n, ir::SweepOver::Columns, rows);
    function.sweep->products = matrix + 1;
    ASSERT_EQ(verify(function, g), "");
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(-2, 2);
    for (const int optimization : {0, 2}) {
      const auto inMemory = compileInMemory(compiled.source(), {optimization, ""});
      const Loaded shared(emit(compiled.source(), EmitKind::SharedLibrary, {optimization, ""}));
      Call call(compiled.function());
      call.inputs[TF_IN_DIRECTIONS].resize(n * TF_DIRECTIONS);
      for (const int array : {TF_IN_Z, TF_IN_DIRECTIONS})
        for (double &value : call.inputs[static_cast<std::size_t>(array)])
          value = uniform(engine);
      Call products = call, again = call;
      const auto expected = interpret(compiled.function(), g, call, {});
      call.run(inMemory->model()->dynamics);
      expectSame(expected, call.outputs, "the matrix");
      products.run(inMemory->model()->dynamics, {1});
      again.run(shared.model()->dynamics, {1});
      expectSame(products.outputs, again.outputs, "shared");
      for (std::size_t lane = 0; lane < TF_DIRECTIONS; ++lane) {
        const auto values = ir::evaluate(g, results, [&](ir::Symbol symbol) {
          const auto index = static_cast<std::size_t>(symbol.index);
          return symbol.kind == SymbolKind::Seed ? call.inputs[TF_IN_DIRECTIONS][index * TF_DIRECTIONS + lane] : argument(call, symbol);
        });
        for (std::size_t k = 0; k < results.size(); ++k)
          EXPECT_EQ(products.outputs.back()[k * TF_DIRECTIONS + lane], values[k]) << seed << ' ' << k << ' ' << lane;
      }
      for (const double entry : products.outputs[static_cast<std::size_t>(matrix)])
        EXPECT_TRUE(entry == untouched || entry == 0) << entry;
    }
  }
}

// What is added to the model is rows of tables.
TEST(Repetitions, CodeDoesNotGrow) {
  const auto linesOf = [](int count) {
    const std::string text = emit(likeGroups(count).source(), EmitKind::LlvmIr, {0, ""});
    return std::ranges::count(text, '\n');
  };
  EXPECT_EQ(linesOf(160), linesOf(80));
}

class RandomFunctions : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomFunctions, InMemoryAndSharedEqualTheInterpreterBitForBit) {
  const unsigned seed = GetParam();
  const int groups = static_cast<int>(seed % 4);
  const Compiled compiled = GetParam() < 12 ? randomFunction(seed, seed % 5 == 0 ? 1500 : 150, groups) : randomSweep(seed, groups);
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (const int optimization : {0, 1, 2, 3}) {
    const auto inMemory = compileInMemory(compiled.source(), {optimization, ""});
    const Loaded shared(emit(compiled.source(), EmitKind::SharedLibrary, {optimization, ""}));
    for (int trial = 0; trial < 4; ++trial) {
      Call call(compiled.function());
      for (double &value : call.inputs[TF_IN_Z])
        value = uniform(engine);
      std::vector<std::uint8_t> mask(static_cast<std::size_t>(groups));
      for (std::uint8_t &byte : mask)
        byte = engine() % 2 == 0 ? 0 : static_cast<std::uint8_t>(1 + trial);
      const auto expected = interpret(compiled.function(), compiled.system.graph, call, mask);
      Call again = call;
      call.run(inMemory->model()->dynamics, mask);
      expectSame(expected, call.outputs, "in memory");
      again.run(shared.model()->dynamics, mask);
      expectSame(expected, again.outputs, "shared");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomFunctions, ::testing::Range(0U, 24U));

class GeneratedCode : public ::testing::Test {
protected:
  Compiled compiled;
  ir::Graph &g = compiled.system.graph;
  NodeId x = g.symbol(SymbolKind::State, 0);
  NodeId y = g.symbol(SymbolKind::State, 1);
  NodeId c(double value) { return g.constant(value); }

  // Values of the roots at states z.
  std::vector<double> run(const std::vector<NodeId> &roots, std::vector<double> states, double alpha = 0, int optimization = 2) {
    ir::Function function{"dynamics", {static_cast<int>(roots.size())}, 0, {}};
    for (std::size_t k = 0; k < roots.size(); ++k)
      function.stores.push_back({0, static_cast<int>(k), roots[k], -1});
    compiled.functions = asDynamics(function);
    const auto inMemory = compileInMemory(compiled.source(), {optimization, ""});
    Call call(function);
    std::copy(states.begin(), states.end(), call.inputs[TF_IN_Z].begin());
    call.inputs[TF_IN_ALPHA][0] = alpha;
    const auto expected = interpret(function, g, call, {});
    call.run(inMemory->model()->dynamics);
    expectSame(expected, call.outputs, "interpreter and code");
    return call.outputs[0];
  }
};

TEST_F(GeneratedCode, EveryOperationAtOrdinaryAndExtremeArguments) {
  std::vector<NodeId> roots;
  for (const Op op : {Op::Neg, Op::Sqrt, Op::Exp, Op::Log, Op::Log10, Op::Sin, Op::Cos, Op::Tan, Op::Asin, Op::Acos, Op::Atan, Op::Sinh,
                      Op::Cosh, Op::Tanh, Op::Abs, Op::Sign, Op::Floor, Op::Ceil, Op::Not})
    roots.push_back(g.unary(op, x));
  for (const Op op :
       {Op::Add, Op::Sub, Op::Mul, Op::Div, Op::Pow, Op::Atan2, Op::Min, Op::Max, Op::Less, Op::LessEqual, Op::Equal, Op::And, Op::Or})
    roots.push_back(g.binary(op, x, y));
  for (const double exponent : {-7.0, -3.0, 3.0, 4.0, 5.0, 13.0, 64.0, 65.0, 2.5})
    roots.push_back(g.binary(Op::Pow, x, c(exponent)));
  roots.push_back(g.binary(Op::Pow, c(2), x));
  roots.push_back(g.binary(Op::Pow, c(10), x));
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values{0.0, -0.0,  0.3,    -0.7,  1.0,      -1.0,      2.5,
                                   1e6, -3e17, 1e-320, 1e300, infinity, -infinity, std::numeric_limits<double>::quiet_NaN()};
  for (const double a : values)
    for (const double b : {0.5, 0.0, infinity, std::numeric_limits<double>::quiet_NaN()})
      run(roots, {a, b});
}

TEST_F(GeneratedCode, SineAndCosineOfOneAngleAreOneCall) {
  const NodeId sine = g.unary(Op::Sin, x), cosine = g.unary(Op::Cos, x);
  std::mt19937_64 random(1);
  for (const double range : {1.0, 100.0, 2e6})
    for (int k = 0; k < 20; ++k)
      run({sine, cosine}, {std::uniform_real_distribution<double>(-range, range)(random), 0});
  const std::string text = emit(compiled.source(), EmitKind::LlvmIr, {2, ""});
  int calls = 0;
  for (std::size_t at = text.find("@sine.cosine("); at != std::string::npos; at = text.find("@sine.cosine(", at + 1))
    ++calls;
  EXPECT_EQ(calls, 2) << text;  // and the definition
}

TEST_F(GeneratedCode, SelectTakesOneBranchAtZeroAndOne) {
  const NodeId alpha = g.symbol(SymbolKind::StepVariable, 0);
  const NodeId nan = g.unary(Op::Sqrt, y);  // y < 0
  for (const int optimization : {0, 2, 3}) {
    EXPECT_EQ(run({g.select(alpha, x, nan)}, {3, -1}, 1, optimization)[0], 3);
    EXPECT_EQ(run({g.select(alpha, nan, x)}, {3, -1}, 0, optimization)[0], 3);
    EXPECT_TRUE(std::isnan(run({g.select(alpha, nan, x)}, {3, -1}, 1, optimization)[0]));
    EXPECT_EQ(run({g.select(alpha, x, y)}, {3, -1}, 0.25, optimization)[0], 0.25 * 3 + 0.75 * -1);
  }
}

TEST_F(GeneratedCode, ConditionsAreBits) {
  const NodeId condition =
      g.binary(Op::Or, g.binary(Op::And, g.binary(Op::Less, x, y), g.binary(Op::Less, c(0), x)), g.binary(Op::Equal, x, c(-2)));
  const std::vector<NodeId> roots{g.ternary(Op::IfElse, condition, x, y), condition, g.add(g.unary(Op::Not, condition), x)};
  EXPECT_EQ(run(roots, {1, 2}), (std::vector<double>{1, 1, 1}));
  EXPECT_EQ(run(roots, {-1, 2}), (std::vector<double>{2, 0, 0}));
  EXPECT_EQ(run(roots, {-2, 2}), (std::vector<double>{-2, 1, -2}));
  // Only the two outputs that are numbers are converted.
  const std::string text = emit(compiled.source(), EmitKind::LlvmIr, {2, ""});
  int conversions = 0;
  for (std::size_t at = text.find("uitofp"); at != std::string::npos; at = text.find("uitofp", at + 1))
    ++conversions;
  EXPECT_EQ(conversions, 2) << text;
}

TEST_F(GeneratedCode, LongRunsOfZerosAreCleared) {
  std::vector<NodeId> roots(100, c(0));
  roots[40] = x;
  roots[99] = y;
  const auto values = run(roots, {3, 4});
  EXPECT_EQ(values[40], 3);
  EXPECT_EQ(values[99], 4);
  EXPECT_LT(emit(compiled.source(), EmitKind::LlvmIr, {0, ""}).size(), 4000U);
}

TEST_F(GeneratedCode, UnmaskedRowsAndTheirInputsAreLeftAlone) {
  const NodeId shared = g.unary(Op::Sin, x);
  const ir::Function function{"dynamics", {3}, 2, {{0, 0, g.add(shared, y), 0}, {0, 1, g.mul(shared, y), 1}, {0, 2, c(7), -1}}};
  compiled.functions = asDynamics(function);
  const auto inMemory = compileInMemory(compiled.source(), {2, ""});
  Call call(function);
  call.inputs[TF_IN_Z] = {0.5, 2};
  call.run(inMemory->model()->dynamics, {0, 255});
  EXPECT_EQ(call.outputs[0], (std::vector<double>{untouched, sineAndCosine(0.5).sine * 2, 7}));
}

TEST_F(GeneratedCode, SquareRootIsAnInstructionAndCallsNeedNoStub) {
  const NodeId root = g.add(g.unary(Op::Sqrt, x), g.unary(Op::Exp, y));
  const ir::Function function{"dynamics", {1}, 0, {{0, 0, root, -1}}};
  compiled.functions = asDynamics(function);
  const std::string text = emit(compiled.source(), EmitKind::Assembly, {2, ""});
#ifdef __x86_64__
  EXPECT_NE(text.find("sqrtsd"), std::string::npos) << text;
  EXPECT_NE(text.find("*exp@GOTPCREL"), std::string::npos) << text;
#endif
  EXPECT_EQ(text.find("@PLT"), std::string::npos) << text;
}

TEST(GeneratedFiles, TheSameInputGivesTheSameBytes) {
  for (const EmitKind kind : {EmitKind::LlvmIr, EmitKind::Assembly, EmitKind::Object, EmitKind::SharedLibrary}) {
    const Compiled first = randomFunction(5, 1000, 3);
    const Compiled second = randomFunction(5, 1000, 3);
    EXPECT_TRUE(emit(first.source(), kind, {2, "h"}) == emit(second.source(), kind, {2, "h"})) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace tf::codegen::testing
