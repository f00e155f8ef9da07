#include "runtime/model/model_instance.h"

#include "runtime/model/nearest_name.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

double parameter(const ModelInstance &instance, std::string_view name) {
  const auto found = instance.find(name);
  return instance.parameters()[static_cast<std::size_t>(instance.model().variables[found->variable].index)];
}

// The particle's model with the flags of one variable changed.
struct Flagged {
  Flagged(std::string_view name, std::int32_t flags)
      : variables(test::particleModel().variables, test::particleModel().variables + test::particleModel().variable_count),
        model(test::particleModel()) {
    for (tf_variable &variable : variables)
      if (variable.name == name)
        variable.flags = flags;
    model.variables = variables.data();
  }
  std::vector<tf_variable> variables;
  tf_model model;
};

std::string setError(ModelInstance &instance, std::string_view name, double value) {
  const auto set = instance.set(name, value);
  return set.ok() ? "" : set.error();
}

std::string setError(const Flagged &flagged, std::string_view name, double value) {
  ModelInstance instance(flagged.model);
  return setError(instance, name, value);
}

TEST(ModelInstance, EvaluatesBindingsOfBindings) {
  ModelInstance instance(test::particleModel());
  EXPECT_DOUBLE_EQ(parameter(instance, "weight"), 9.81);
  EXPECT_DOUBLE_EQ(parameter(instance, "rate"), 9.81);
  ASSERT_TRUE(instance.set("m", 2).ok());
  ASSERT_TRUE(instance.set("g", 5).ok());
  EXPECT_DOUBLE_EQ(parameter(instance, "weight"), 10);
  EXPECT_DOUBLE_EQ(parameter(instance, "rate"), 5);
}

TEST(ModelInstance, SetBoundParametersKeepTheirValuesAndOthersFollow) {
  ModelInstance instance(test::particleModel());
  ASSERT_TRUE(instance.set("weight", 3).ok());
  ASSERT_TRUE(instance.set("m", 2).ok());
  EXPECT_DOUBLE_EQ(parameter(instance, "weight"), 3);
  EXPECT_DOUBLE_EQ(parameter(instance, "rate"), 1.5);
}

TEST(ModelInstance, SetsStartsAndInputsAlsoByAlias) {
  ModelInstance instance(test::particleModel());
  ASSERT_TRUE(instance.set("x", 4).ok());
  ASSERT_TRUE(instance.set("depth", 3).ok());
  ASSERT_TRUE(instance.set("der( q[1] )", 7).ok());
  ASSERT_TRUE(instance.set("vy", -1).ok());
  ASSERT_TRUE(instance.set("u[2]", 6).ok());
  const Starts starts = instance.starts(0);
  EXPECT_EQ(starts.q, (std::vector<double>{4, -3}));
  EXPECT_EQ(starts.v, (std::vector<double>{7, -1}));
  EXPECT_EQ(starts.u, (std::vector<double>{0, 6}));
  EXPECT_TRUE(instance.isSet(TF_KIND_INPUT, 1));
  EXPECT_FALSE(instance.isSet(TF_KIND_INPUT, 0));
  EXPECT_FALSE(instance.isSet(TF_KIND_GAP, 0));
  EXPECT_FALSE(instance.isSet(TF_KIND_INPUT, 2));
}

TEST(ModelInstance, FindsNamesRegardlessOfBlanks) {
  const ModelInstance instance(test::particleModel());
  EXPECT_EQ(instance.find("q[ 2 ]")->variable, instance.find("q[2]")->variable);
  EXPECT_EQ(instance.find("depth")->sign, -1);
  EXPECT_EQ(instance.find("depth")->variable, instance.find("q[2]")->variable);
  EXPECT_FALSE(instance.find("q").has_value());
  EXPECT_FALSE(instance.find("").has_value());
  EXPECT_EQ(instance.nameOf(TF_KIND_PARAMETER, 1), "g");
  EXPECT_EQ(instance.nameOf(TF_KIND_COORDINATE, 8), "coordinate 9");
}

TEST(ModelInstance, KeepsBlanksInsideQuotedNames) {
  tf_model model = test::relayModel();
  std::vector<tf_variable> variables(model.variables, model.variables + model.variable_count);
  variables[2].name = "'a b'";
  model.variables = variables.data();
  const ModelInstance instance(model);
  EXPECT_TRUE(instance.find(" 'a b' ").has_value());
  EXPECT_FALSE(instance.find("'ab'").has_value());
}

TEST(ModelInstance, RefusesWhatCannotBeSet) {
  ModelInstance instance(test::particleModel());
  EXPECT_EQ(setError(instance, "wieght", 1), "model 'Particle' has no variable 'wieght'; did you mean 'weight'?");
  EXPECT_EQ(setError(instance, "qwertyuiop", 1), "model 'Particle' has no variable 'qwertyuiop'");
  EXPECT_EQ(setError(instance, "q", 1), "'q' of model 'Particle' is an array: name one of its elements, 'q[1]' to 'q[2]'");
  EXPECT_EQ(setError(instance, "time", 1), "'time' is computed by the model and cannot be set");
  EXPECT_EQ(setError(instance, "floor.gap", 1), "'floor.gap' is computed by the model and cannot be set");
  EXPECT_EQ(setError(instance, "der(der(q[1]))", 1), "'der(der(q[1]))' is computed by the model and cannot be set");
  EXPECT_EQ(setError(Flagged("m", TF_STRUCTURAL), "m", 1),
            "'m' is structural: its value is part of the compiled model; compile the model again with another value");
  EXPECT_EQ(setError(Flagged("m", TF_PROTECTED), "m", 1), "'m' is protected and cannot be set");
  EXPECT_EQ(setError(Flagged("m", 0), "m", 1), "'m' is final and cannot be set");
  EXPECT_EQ(setError(Flagged("q[1]", TF_FIXED), "q[1]", 1), "the start of 'q[1]' is final and cannot be set");
}

TEST(ModelInstance, RefusesBadValues) {
  ModelInstance instance(test::particleModel());
  EXPECT_EQ(setError(instance, "mu", -0.1), "'mu' = -0.1 is below its minimum 0");
  EXPECT_EQ(setError(instance, "e", 1.5), "'e' = 1.5 is above its maximum 1");
  EXPECT_EQ(setError(instance, "m", std::nan("")), "'m' cannot be set to NaN");
  EXPECT_EQ(setError(instance, "q[1]", unbounded), "'q[1]' cannot be infinite");
  EXPECT_EQ(setError(instance, "u[1]", -unbounded), "'u[1]' cannot be infinite");
  EXPECT_EQ(setError(instance, "m", unbounded), "");
  EXPECT_EQ(setError(Flagged("m", TF_SETTABLE | TF_BOOLEAN), "m", 2), "'m' is Boolean: its value is 0 (false) or 1 (true), not 2");
  EXPECT_EQ(setError(Flagged("m", TF_SETTABLE | TF_BOOLEAN), "m", 0), "");
  EXPECT_EQ(setError(Flagged("m", TF_SETTABLE | TF_INTEGER), "m", 2.5), "'m' is an Integer and cannot be 2.5");
  EXPECT_EQ(setError(Flagged("m", TF_SETTABLE | TF_INTEGER), "m", -3), "");
}

TEST(ModelInstance, RefusedValuesChangeNothing) {
  ModelInstance instance(test::particleModel());
  ASSERT_TRUE(instance.set("mu", 0.5).ok());
  ASSERT_FALSE(instance.set("mu", -1).ok());
  EXPECT_EQ(parameter(instance, "mu"), 0.5);
}

TEST(ModelInstance, ChecksComputedParameters) {
  Flagged flagged("m", TF_SETTABLE);
  for (tf_variable &variable : flagged.variables)
    if (std::string_view(variable.name) == "weight")
      variable.min = 0;
  ModelInstance instance(flagged.model);
  EXPECT_TRUE(instance.checkParameters().ok());
  ASSERT_TRUE(instance.set("g", -1).ok());
  EXPECT_EQ(instance.checkParameters().error(), "'weight' = -1 is below its minimum 0 (computed from other parameters)");
  ASSERT_TRUE(instance.set("m", 0).ok());
  EXPECT_EQ(instance.checkParameters().error(), "'rate', which is computed from other parameters, has no value (NaN)");
}

TEST(EditDistance, CountsEditsUpToTheLimit) {
  EXPECT_EQ(editDistance("floor", "floor", 3), 0);
  EXPECT_EQ(editDistance("flor", "floor", 3), 1);
  EXPECT_EQ(editDistance("lfoor", "floor", 3), 1);
  EXPECT_EQ(editDistance("kitten", "sitting", 5), 3);
  EXPECT_EQ(editDistance("kitten", "sitting", 2), 3);
  EXPECT_EQ(editDistance("", "abc", 5), 3);
  EXPECT_EQ(editDistance("abcdef", "", 2), 3);
}

TEST(NearestName, PrefersTheNearest) {
  NearestName nearest("masss");
  nearest.offer("mast");
  nearest.offer("mass");
  nearest.offer("grass");
  EXPECT_EQ(nearest.suggestion(), "; did you mean 'mass'?");
}

}  // namespace

}  // namespace tf::runtime
