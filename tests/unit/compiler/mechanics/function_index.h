// The functions of a derived model, in their order.
#pragma once

namespace tf::test {

enum FunctionIndex {
  Bindings,
  Starts,
  Kinematics,
  KinematicsDerivatives,
  Dynamics,
  Switching,
  ContactTerms,
  ContactParameters,
  ConstraintTerms,
  SwitchGradients,
  StepDerivatives,
  DynamicsDerivatives,
  Outputs,
  Energies,
  ContactDynamics,
  GapBounds
};

}  // namespace tf::test
