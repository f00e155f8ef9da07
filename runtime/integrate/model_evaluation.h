// The generated functions of a model at one point (t, y), with their results in named arrays. y = (q, v, z, tau).
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/integrate/contact_scales.h"
#include "runtime/integrate/gap_screen.h"
#include "runtime/integrate/mass_sample.h"
#include "runtime/integrate/mobility.h"
#include "runtime/model/input_signals.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tf::runtime {

// Shapes and layouts are those of runtime/abi/tf_model.h. Arrays hold the results of the latest call of the function named beside them.
// The acceleration of a gap, m/s², and the sum of the magnitudes of its terms.
struct GapAcceleration {
  double value = 0, size = 0;
};

class ModelEvaluation {
public:
  ModelEvaluation(const tf_model &model, const InputSignals &inputs);
  ModelEvaluation(const ModelEvaluation &) = delete;
  ModelEvaluation &operator=(const ModelEvaluation &) = delete;

  // np values, which must outlive the evaluation; factorises a constant mass matrix. False: it is not positive definite.
  bool setParameters(const double *parameters);
  // A time strictly inside the smooth piece of the inputs that is meant.
  void setSegment(double segment);
  // Adds s · direction [nu] to the inputs from now on.
  void shiftInputs(const double *direction, double s);
  [[nodiscard]] double segment() const { return segment_; }
  // The state [stateSize()] must stay where it is until the functions have been called.
  void setPoint(double time, const double *state);

  // M, f, z', the rows of the constraints and the mobility. False: M is not positive definite, or H not finite.
  bool dynamics();
  // f and z' for new step variables at the same point.
  // With a sample, which models with mass products allow: instead of M.
  void forces(MassSample *sample = nullptr);
  // M at the point of the last evaluation of forces, where that was with a sample.
  void completeMass();
  // f and z' (and M, which is not factorised) with the terms of the contacts and friction elements of mask [nc + nf].
  void contactForces(const std::uint8_t *mask, MassSample *sample = nullptr);
  // Factorises a mass matrix that is not constant. False: it is not positive definite.
  bool factoriseMass();
  enum SwitchingPart : std::uint8_t { Gaps = 1, Slips = 2, Conditions = 4 };
  // Gaps and slips of contacts that are asleep are left as they are: these gaps are positive, here and there.
  void switching(int parts = Gaps | Slips | Conditions);
  // Of all contacts.
  void switchingOfAll(int parts = Gaps | Slips | Conditions);
  // Gaps and slips of some contacts only, mask [nc]; the others keep their values.
  void switching(int parts, const std::uint8_t *contacts);
  // Gap and rate of one contact.
  void switchingOf(int contact);
  // Contacts that stay asleep are so all over the box: nq + 1 each, of coordinates and time; `coordinateRate` [nq] are those of the motion.
  void cover(const double *center, const double *radius, const double *coordinateRate);
  // As well, in a screen of one's own, which is used (GapScreen::isUsed).
  void cover(GapScreen &screen, const double *center, const double *radius);
  // mask [nc + nf]
  void contactTerms(const std::uint8_t *mask);
  // d²g/dt² of a contact whose terms have been called, with accelerations [nv].
  [[nodiscard]] GapAcceleration gapAcceleration(int contact, const double *accelerations) const;
  void contactParameters();
  // scales, from the rows at (t, y) and where the coordinates are displaced by their nominal magnitudes. Changes the rows.
  void measureScales(double time, const double *state);
  // Residuals and their rates.
  void constraintResiduals();
  // H and bias
  void constraintRows();
  // mask [ns]
  void switchGradients(const std::uint8_t *mask);
  void stepDerivatives();
  // At the accelerations and forces in `acceleration`, `normalForce`, `tangentForce`; mask [nc + nf].
  void dynamicsDerivatives(const std::uint8_t *mask);
  void kinematics(double *qDot) const {
    if (model_->kinematics != nullptr)
      return model_->kinematics(in_, &qDot, nullptr);
    for (int i = 0; i < model_->nv; ++i)
      qDot[i] = in_[TF_IN_V][i];
  }
  // kinematicMatrix (N) and kinematicsByCoordinate; nothing to do where q' = v.
  void kinematicsDerivatives();
  // Moves the coordinates in `state` along N(q) v, which may be any change of the velocities' kind; quaternions stay of unit length.
  void moveCoordinates(double *state, const double *change);
  void normaliseQuaternions(double *state) const;
  void evaluateOutputs(double *values);
  // At `acceleration`.
  void energies(double &kinetic, double &potential, double &power);

  [[nodiscard]] const tf_model &model() const { return *model_; }
  [[nodiscard]] int stateSize() const { return model_->nq + model_->nv + model_->nz + 1; }
  // Number of tau in the state.
  [[nodiscard]] int tauIndex() const { return stateSize() - 1; }
  [[nodiscard]] int columns() const { return model_->nq + model_->nv + model_->nz + model_->nu + 1; }
  [[nodiscard]] const double *coordinates() const { return in_[TF_IN_Q]; }
  [[nodiscard]] const double *velocities() const { return in_[TF_IN_V]; }
  [[nodiscard]] const double *parameters() const { return in_[TF_IN_P]; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] GapScreen &screen() { return screen_; }
  // A contact's gap, a tangential row's slip, a switch's condition, or anything that contact forces and sliding step variables follow from
  // depends on time, or on inputs that change within the segment.
  [[nodiscard]] bool gapVaries(int contact) const { return varies(contact); }
  [[nodiscard]] bool slipVaries(int row) const { return varies(model_->nc + row); }
  [[nodiscard]] bool conditionVaries(int number) const { return varies(model_->nc + model_->nt + number); }
  [[nodiscard]] bool forcesVary() const { return varies(model_->nc + model_->nt + model_->ns); }
  // Counts the calls of setParameters.
  [[nodiscard]] long long parameterRevision() const { return parameterRevision_; }

  ContactScales scales;  // measureScales
  Mobility mobility;
  std::vector<double> massMatrix, force, stateRate;                               // dynamics
  std::vector<double> gap, gapRate, slip, condition;                              // switching
  std::vector<double> normal, normalBias, tangent, tangentBias, friction, bound;  // contactTerms
  std::vector<double> residual, residualRate;                                     // constraintResiduals
  std::vector<double> constraintJacobian, constraintBias;                         // constraintRows
  std::vector<double> kinematicMatrix, kinematicsByCoordinate;                    // kinematicsDerivatives
  std::vector<double> rate, restitution;                                          // contactParameters
  std::vector<double> conditionGradient;                                          // switchGradients
  std::vector<double> forceByStep, stateRateByStep;                               // stepDerivatives
  std::vector<double> residualByState, stateRateByState, normalByState, tangentByState, frictionByState, boundByState,
      constraintByState;  // dynamicsDerivatives
  // Arguments that others fill in.
  std::vector<double> input, inputRate, stepVariable, acceleration, normalForce, tangentForce, multiplier;

private:
  void evaluateInputs(double time);
  void constraintTerms(bool residuals, bool rows);
  std::vector<double> rowsNearby(double time, const double *state);
  void clearRounding(const std::vector<double> &nearby);
  using SwitchingMask = std::vector<std::uint8_t>;
  void read(const SwitchingMask &mask);
  void selectContacts(int parts, const std::uint8_t *contacts, SwitchingMask &mask) const;
  void renewScreen();
  // Of tf_model::variation.
  [[nodiscard]] bool varies(int entry) const {
    return model_->variation != nullptr &&
           (model_->variation[entry] & (TF_VARIES_WITH_TIME | (constantInputs_ ? 0 : TF_VARIES_WITH_INPUTS))) != 0;
  }

  const tf_model *model_;
  const InputSignals *inputs_;
  const double *in_[TF_IN_COUNT] = {};
  std::array<double *, 9> contactDynamics_;  // its results
  std::vector<double> coordinateChange_, inputShift_, shares_;
  std::vector<double> zero_, displaced_;  // states
  std::vector<std::uint8_t> everything_;  // nc + nf
  double time_ = 0, segment_ = 0;
  long long parameterRevision_ = 0;
  bool constantInputs_ = false;
  // By their parts, of the contacts that are awake at a revision of the screen (−1: none).
  struct AwakeMask {
    SwitchingMask mask;
    long long revision = -1;
  };
  std::array<AwakeMask, 8> awakeMasks_;
  SwitchingMask someMask_, oneMask_;  // of any contacts, and of one at a time
  bool readElsewhere_ = false;        // the gaps of contacts that are asleep are those at a point outside the box
  GapScreen screen_;
  std::vector<double> coordinateRate_, gapAtCenter_, sampledState_, ignoredForce_, ignoredRate_;
  double sampledTime_ = 0;
  bool isSampled_ = false;  // massMatrix is not that of the last evaluation of forces
};

}  // namespace tf::runtime
