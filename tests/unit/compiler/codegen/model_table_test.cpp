// Every field of the table from a HybridSystem through a shared library and back.
#include "compiled_fixture.h"

#include "compiler/codegen/c_header.h"
#include "compiler/codegen/model_facts.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace tf::codegen::testing {
namespace {

using ::testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

class ModelTable : public ::testing::Test {
protected:
  ModelTable() {
    const std::string text = "model m\n  contact floor;\nend m;\n";
    const FileId file = sources.add("dir/m.tf", text);
    const Span span{file, static_cast<std::uint32_t>(text.find("floor")), static_cast<std::uint32_t>(text.find("floor") + 5)};
    ir::Graph &g = system.graph;
    system.name = "m";
    system.description = "says \"hé\"\n";
    system.nq = 6;
    system.nv = 5;
    system.motion.addCoordinates(2);
    system.motion.addRotation();
    system.nz = 1;
    system.nu = 1;
    system.np = 4;
    system.quantities = {{"time", "s", "", TF_KIND_TIME, 0, 0, -infinity, infinity, 1, {}},
                         {"q[1]", "m", "position", TF_KIND_COORDINATE, 0, TF_FIXED | TF_SETTABLE, -1, 5, 0.1, span},
                         {"der(q[1])", "m/s", "", TF_KIND_VELOCITY, 0, 0, -infinity, infinity, 1, span}};
    system.aliases = {{"v", "speed", 2, -1}};
    const ir::NodeId p0 = g.symbol(ir::SymbolKind::Parameter, 0);
    const ir::NodeId p1 = g.symbol(ir::SymbolKind::Parameter, 1);
    const ir::NodeId p2 = g.symbol(ir::SymbolKind::Parameter, 2);
    system.parameterValues = {1.5, 9, 9, -0.25};
    system.parameterBindings = {-1, g.add(p0, p2), g.mul(p0, p0), -1};
    system.mass.assign(25, g.constant(0));
    for (const int entry : {0, 6, 12, 18, 24})
      system.mass[entry] = p0;
    for (const int entry : {1, 5, 13, 17, 3, 15})
      system.mass[entry] = p1;
    system.contacts = {{"floor", span, -1, -1, -1, {}, 0, 1, -1, -1, -1, TF_LAW_STRONGE, 0.5}};
    system.frictions = {{"brake", {}, 1, 2, -1, TF_FRICTION_POLYHEDRAL}};
    system.tangents.resize(3);
    system.constraints = {{"loop", span, 0, 2, false, 0.25}};
    system.constraintRows.resize(2);
    const ir::NodeId signal = g.mul(g.symbol(ir::SymbolKind::Input, 0), p0);
    system.switches = {{"x >= 0", span, g.add(signal, g.symbol(ir::SymbolKind::Time)), TF_SWITCH_CONTINUOUS, true}};
    system.tangents[1].slip = g.add(g.symbol(ir::SymbolKind::Velocity, 0), g.unary(ir::Op::Cos, g.symbol(ir::SymbolKind::Time)));
    system.frictions[0].bound = signal;
    system.outputs = {p0};
    system.experiment.stopTime = 2.5;
  }

  [[nodiscard]] ModelSource source() const { return {system, functions, sources}; }

  void expectTable(const tf_model &m) const {
    EXPECT_EQ(m.magic, TF_MAGIC);
    EXPECT_EQ(m.abi_version, TF_ABI_VERSION);
    EXPECT_STREQ(m.name, "m");
    EXPECT_STREQ(m.description, "says \"hé\"\n");
    EXPECT_THAT(m.generator, ::testing::StartsWith("tfc "));
    EXPECT_STREQ(m.hash, "content");
    EXPECT_EQ((std::vector{m.nq, m.nv, m.nz, m.nu, m.np, m.nc, m.nt, m.ns, m.no, m.nf, m.nr, m.nk, m.nh, m.variable_count, m.alias_count}),
              (std::vector<int>{6, 5, 1, 1, 4, 1, 3, 1, 1, 1, 1, 1, 2, 3, 1}));
    EXPECT_EQ(m.binding_depth, 2);
    EXPECT_EQ(m.mass_is_constant, 1);
    EXPECT_EQ(m.locality, 0);
    EXPECT_EQ(m.uniform_flight, 0);
    EXPECT_EQ((std::vector(m.mass_rows, m.mass_rows + 6)), (std::vector{0, 0, 1, 1, 3, 3}));
    EXPECT_EQ((std::vector(m.mass_columns, m.mass_columns + 3)), (std::vector{0, 0, 2}));
    // One gap, three slips, one condition, the forces.
    EXPECT_EQ((std::vector(m.variation, m.variation + 6)),
              (std::vector<int>{0, 0, TF_VARIES_WITH_TIME, 0, TF_VARIES_WITH_TIME | TF_VARIES_WITH_INPUTS, TF_VARIES_WITH_INPUTS}));
    EXPECT_TRUE(std::isnan(m.start_time) && std::isnan(m.tolerance) && std::isnan(m.interval));
    EXPECT_EQ(m.stop_time, 2.5);
    EXPECT_EQ((std::vector(m.parameters, m.parameters + 4)), (std::vector{1.5, 0.0, 0.0, -0.25}));
  }

  static void expectRows(const tf_model &m) {
    const tf_variable &q = m.variables[1];
    EXPECT_STREQ(q.name, "q[1]");
    EXPECT_STREQ(q.unit, "m");
    EXPECT_STREQ(q.description, "position");
    EXPECT_EQ((std::vector{q.kind, q.index, q.flags}), (std::vector<int>{TF_KIND_COORDINATE, 0, TF_FIXED | TF_SETTABLE}));
    EXPECT_EQ((std::vector{q.min, q.max, q.nominal}), (std::vector<double>{-1, 5, 0.1}));
    EXPECT_STREQ(q.location.file, "dir/m.tf");
    EXPECT_EQ((std::vector{q.location.line, q.location.column}), (std::vector{2, 11}));
    EXPECT_STREQ(m.variables[0].location.file, "");
    EXPECT_STREQ(m.aliases[0].name, "v");
    EXPECT_STREQ(m.aliases[0].description, "speed");
    EXPECT_EQ(m.aliases[0].variable, 2);
    EXPECT_EQ(m.aliases[0].sign, -1);
    EXPECT_STREQ(m.contacts[0].name, "floor");
    EXPECT_EQ((std::vector{m.contacts[0].tangent_first, m.contacts[0].tangent_count, m.contacts[0].law}),
              (std::vector<int>{0, 1, TF_LAW_STRONGE}));
    EXPECT_EQ(m.contacts[0].nominal, 0.5);
    EXPECT_EQ(m.contacts[0].friction_form, TF_FRICTION_EXACT);
    EXPECT_EQ(m.frictions[0].friction_form, TF_FRICTION_POLYHEDRAL);
    EXPECT_EQ(m.contacts[0].location.line, 2);
    EXPECT_STREQ(m.frictions[0].name, "brake");
    EXPECT_EQ((std::vector{m.frictions[0].tangent_first, m.frictions[0].tangent_count}), (std::vector{1, 2}));
    EXPECT_STREQ(m.constraints[0].name, "loop");
    EXPECT_EQ((std::vector{m.constraints[0].row_first, m.constraints[0].row_count, m.constraints[0].holonomic}), (std::vector{0, 2, 0}));
    EXPECT_EQ(m.constraints[0].nominal, 0.25);
    EXPECT_EQ(m.constraints[0].location.line, 2);
    EXPECT_EQ(m.quaternions[0], 2);
    EXPECT_STREQ(m.switches[0].text, "x >= 0");
    EXPECT_EQ((std::vector{m.switches[0].kind, m.switches[0].zero_is_positive}), (std::vector<int>{TF_SWITCH_CONTINUOUS, 1}));
    EXPECT_EQ(m.switches[0].location.column, 11);
  }

  HybridSystem system;
  SourceManager sources;
  std::vector<ir::Function> functions{modelFunctionCount};
};

TEST_F(ModelTable, SurvivesTheSharedLibrary) {
  const Loaded shared(emit(source(), EmitKind::SharedLibrary, {2, "content"}));
  expectTable(*shared.model());
  expectRows(*shared.model());
}

TEST_F(ModelTable, IsTheSameInMemory) {
  const auto inMemory = compileInMemory(source(), {2, "content"});
  expectTable(*inMemory->model());
  expectRows(*inMemory->model());
}

// Function number k stores k: each must be reached by its own pointer.
TEST_F(ModelTable, FunctionPointersAreInOrder) {
  for (std::size_t k = 0; k < modelFunctionCount; ++k)
    if (k != 2)
      functions[k] = {"f" + std::to_string(k), {1}, 0, {{0, 0, system.graph.constant(static_cast<double>(k)), -1}}};
  const Loaded shared(emit(source(), EmitKind::SharedLibrary, {2, ""}));
  const tf_model &m = *shared.model();
  const std::vector<tf_function> pointers{m.bindings,         m.starts,           m.kinematics,       m.kinematics_derivatives,
                                          m.dynamics,         m.switching,        m.contact_terms,    m.contact_parameters,
                                          m.constraint_terms, m.switch_gradients, m.step_derivatives, m.dynamics_derivatives,
                                          m.outputs,          m.energies,         m.contact_dynamics, m.gap_bounds};
  for (std::size_t k = 0; k < pointers.size(); ++k) {
    if (k == 2) {
      EXPECT_EQ(pointers[k], nullptr);
      continue;
    }
    Call call(functions[k]);
    call.run(pointers[k]);
    EXPECT_EQ(call.outputs[0][0], static_cast<double>(k));
  }
}

TEST_F(ModelTable, MassThatDependsOnCoordinatesIsNotConstant) {
  system.mass[0] = system.graph.unary(ir::Op::Cos, system.graph.symbol(ir::SymbolKind::Coordinate, 0));
  EXPECT_FALSE(massIsConstant(system));
}

TEST_F(ModelTable, BindingDepthIsTheLongestChain) {
  ir::Graph &g = system.graph;
  EXPECT_EQ(bindingDepth(system), 2);
  system.parameterBindings = {-1, -1, -1, -1};
  EXPECT_EQ(bindingDepth(system), 0);
  system.parameterBindings = {g.symbol(ir::SymbolKind::Parameter, 1), g.symbol(ir::SymbolKind::Parameter, 2),
                              g.symbol(ir::SymbolKind::Parameter, 3), -1};
  EXPECT_EQ(bindingDepth(system), 3);
}

TEST_F(ModelTable, EmptySystemHasNullTables) {
  const HybridSystem empty;
  const Loaded shared(emit({empty, functions, sources}, EmitKind::SharedLibrary, {2, ""}));
  EXPECT_EQ(shared.model()->variables, nullptr);
  EXPECT_EQ(shared.model()->parameters, nullptr);
  EXPECT_EQ(shared.model()->binding_depth, 0);
}

TEST_F(ModelTable, HeaderNamesEveryQuantity) {
  system.quantities.push_back({"q_1", "", "looks */ alike", TF_KIND_PARAMETER, 3, 0, -infinity, infinity, 1, {}});
  const std::string header = emitHeader(system);
  EXPECT_THAT(header, HasSubstr("extern const tf_model tf_model_v1;"));
  EXPECT_THAT(header, HasSubstr("  m_q_1 = 1, /* q[1] [m]: position */\n"));
  EXPECT_THAT(header, HasSubstr("  m_q_1_2 = 3, /* q_1: looks  / alike */\n"));
  EXPECT_THAT(header, HasSubstr("  m_der_q_1 = 2, /* der(q[1]) [m/s] */\n"));
  EXPECT_THAT(header, HasSubstr("  m_v = 2, /* v, with the opposite sign */\n"));
  EXPECT_THAT(header, HasSubstr("  m_p_q_1 = 3,\n"));
  EXPECT_THAT(header, HasSubstr("  m_contact_floor = 0,\n"));
  EXPECT_THAT(header, HasSubstr("  m_switch_1 = 0, /* x >= 0 */\n"));
  EXPECT_THAT(header, HasSubstr("  m_count_tangents = 3,\n"));
}

}  // namespace
}  // namespace tf::codegen::testing
