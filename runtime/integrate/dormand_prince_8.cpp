#include "runtime/integrate/dormand_prince_8.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tf::runtime {

namespace {

// k1 … k12, dy/dt at the end, and the three stages of the dense output.
constexpr std::size_t stageCount = 12, storedCount = 16, coefficientCount = 7;

// With the ends, as many as the dense output's order asks for.
constexpr int insideCount = 6;

constexpr double nodes[] = {0,
                            0.0526001519587677318785587544488,
                            0.0789002279381515978178381316732,
                            0.118350341907227396726757197510,
                            0.281649658092772603273242802490,
                            1.0 / 3,
                            0.25,
                            4.0 / 13,
                            127.0 / 195,
                            0.6,
                            6.0 / 7,
                            1};
constexpr double weights[12][11] = {
    {},
    {5.26001519587677318785587544488e-2},
    {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
    {2.95875854768068491816892993775e-2, 0, 8.87627564304205475450678981324e-2},
    {2.41365134159266685502369798665e-1, 0, -8.84549479328286085344864962717e-1, 9.24834003261792003115737966543e-1},
    {3.7037037037037037037037037037e-2, 0, 0, 1.70828608729473871279604482173e-1, 1.25467687566822425016691814123e-1},
    {3.7109375e-2, 0, 0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -1.7578125e-2},
    {3.70920001185047927108779319836e-2, 0, 0, 1.70383925712239993810214054705e-1, 1.07262030446373284651809199168e-1,
     -1.53194377486244017527936158236e-2, 8.27378916381402288758473766002e-3},
    {6.24110958716075717114429577812e-1, 0, 0, -3.36089262944694129406857109825e0, -8.68219346841726006818189891453e-1,
     2.75920996994467083049415600797e1, 2.01540675504778934086186788979e1, -4.34898841810699588477366255144e1},
    {4.77662536438264365890433908527e-1, 0, 0, -2.48811461997166764192642586468e0, -5.90290826836842996371446475743e-1,
     2.12300514481811942347288949897e1, 1.52792336328824235832596922938e1, -3.32882109689848629194453265587e1,
     -2.03312017085086261358222928593e-2},
    {-9.3714243008598732571704021658e-1, 0, 0, 5.18637242884406370830023853209e0, 1.09143734899672957818500254654e0,
     -8.14978701074692612513997267357e0, -1.85200656599969598641566180701e1, 2.27394870993505042818970056734e1,
     2.49360555267965238987089396762e0, -3.0467644718982195003823669022e0},
    {2.27331014751653820792359768449e0, 0, 0, -1.05344954667372501984066689879e1, -2.00087205822486249909675718444e0,
     -1.79589318631187989172765950534e1, 2.79488845294199600508499808837e1, -2.85899827713502369474065508674e0,
     -8.87285693353062954433549289258e0, 1.23605671757943030647266201528e1, 6.43392746015763530355970484046e-1},
};
constexpr double result[1][12] = {{5.42937341165687622380535766363e-2, 0, 0, 0, 0, 4.45031289275240888144113950566e0,
                                   1.89151789931450038304281599044e0, -5.8012039600105847814672114227e0, 3.1116436695781989440891606237e-1,
                                   -1.52160949662516078556178806805e-1, 2.01365400804030348374776537501e-1,
                                   4.47106157277725905176885569043e-2}};
constexpr double fifth[1][12] = {{0.1312004499419488073250102996e-01, 0, 0, 0, 0, -0.1225156446376204440720569753e+01,
                                  -0.4957589496572501915214079952e+00, 0.1664377182454986536961530415e+01,
                                  -0.3503288487499736816886487290e+00, 0.3341791187130174790297318841e+00,
                                  0.8192320648511571246570742613e-01, -0.2235530786388629525884427845e-01}};
// The formula of order 8 less that of order 3, which has k1, k9 and k12.
constexpr double third[1][12] = {{result[0][0] - 0.244094488188976377952755905512, 0, 0, 0, 0, result[0][5], result[0][6], result[0][7],
                                  result[0][8] - 0.733846688281611857341361741547, result[0][9], result[0][10],
                                  result[0][11] - 0.220588235294117647058823529412e-01}};

constexpr double leastDamping = 0.01;

// Of steps that begin at a switch, behind which rates may be powers of the time since then: there the estimates of both orders are of the
// size of the error, and either may pass through zero. Of y' = −1 − √|y| and the like, from y = 0, it is at most 5.5 times this one.
double errorBehindSwitch(double five, double three) { return std::max(2 * std::abs(five), 0.2 * std::abs(three)); }

// Of estimates of orders 5 and 3 (II.10). The squares of errors far below any tolerance are zero.
double dampedError(double five, double three) {
  const double squares = five * five + three * three;
  return squares > 0 ? five * std::max(leastDamping, std::abs(five) / std::sqrt(squares)) : five;
}

// Stages 14 to 16, out of k1 … k12, k13 = dy/dt at the end, and those before.
constexpr double extraNodes[3] = {0.1, 0.2, 7.0 / 9};
constexpr double extra[3][15] = {
    {5.61675022830479523392909219681e-2, 0, 0, 0, 0, 0, 2.53500210216624811088794765333e-1, -2.46239037470802489917441475441e-1,
     -1.24191423263816360469010140626e-1, 1.5329179827876569731206322685e-1, 8.20105229563468988491666602057e-3,
     7.56789766054569976138603589584e-3, -8.298e-3},
    {3.18346481635021405060768473261e-2, 0, 0, 0, 0, 2.83009096723667755288322961402e-2, 5.35419883074385676223797384372e-2,
     -5.49237485713909884646569340306e-2, 0, 0, -1.08347328697249322858509316994e-4, 3.82571090835658412954920192323e-4,
     -3.40465008687404560802977114492e-4, 1.41312443674632500278074618366e-1},
    {-4.28896301583791923408573538692e-1, 0, 0, 0, 0, -4.69762141536116384314449447206e0, 7.68342119606259904184240953878e0,
     4.06898981839711007970213554331e0, 3.56727187455281109270669543021e-1, 0, 0, 0, -1.39902416515901462129418009734e-3,
     2.9475147891527723389556272149e0, -9.15095847217987001081870187138e0},
};
constexpr double dense[4][16] = {
    {-0.84289382761090128651353491142e+01, 0, 0, 0, 0, 0.56671495351937776962531783590e+00, -0.30689499459498916912797304727e+01,
     0.23846676565120698287728149680e+01, 0.21170345824450282767155149946e+01, -0.87139158377797299206789907490e+00,
     0.22404374302607882758541771650e+01, 0.63157877876946881815570249290e+00, -0.88990336451333310820698117400e-01,
     0.18148505520854727256656404962e+02, -0.91946323924783554000451984436e+01, -0.44360363875948939664310572000e+01},
    {0.10427508642579134603413151009e+02, 0, 0, 0, 0, 0.24228349177525818288430175319e+03, 0.16520045171727028198505394887e+03,
     -0.37454675472269020279518312152e+03, -0.22113666853125306036270938578e+02, 0.77334326684722638389603898808e+01,
     -0.30674084731089398182061213626e+02, -0.93321305264302278729567221706e+01, 0.15697238121770843886131091075e+02,
     -0.31139403219565177677282850411e+02, -0.93529243588444783865713862664e+01, 0.35816841486394083752465898540e+02},
    {0.19985053242002433820987653617e+02, 0, 0, 0, 0, -0.38703730874935176555105901742e+03, -0.18917813819516756882830838328e+03,
     0.52780815920542364900561016686e+03, -0.11573902539959630126141871134e+02, 0.68812326946963000169666922661e+01,
     -0.10006050966910838403183860980e+01, 0.77771377980534432092869265740e+00, -0.27782057523535084065932004339e+01,
     -0.60196695231264120758267380846e+02, 0.84320405506677161018159903784e+02, 0.11992291136182789328035130030e+02},
    {-0.25693933462703749003312586129e+02, 0, 0, 0, 0, -0.15418974869023643374053993627e+03, -0.23152937917604549567536039109e+03,
     0.35763911791061412378285349910e+03, 0.93405324183624310003907691704e+02, -0.37458323136451633156875139351e+02,
     0.10409964950896230045147246184e+03, 0.29840293426660503123344363579e+02, -0.43533456590011143754432175058e+02,
     0.96324553959188282948394950600e+02, -0.39177261675615439165231486172e+02, -0.14972683625798562581422125276e+03},
};

}  // namespace

DormandPrince8::DormandPrince8(int size, double tolerance)
    : ExplicitMethod(size, stageCount, storedCount, coefficientCount, 6.1, 1), tolerance_(tolerance), inside_(size, insideCount) {}

bool DormandPrince8::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
                           double /*accuracy*/) {
  dynamics_ = &dynamics;
  t0_ = t0;
  scale_ = scale;
  inside_.forget();
  return advance(y0, f0, h);
}

// The error is the estimate of order 5, damped by the one of order 3; of each component, so that the ratio of one does not vouch
// for others.
bool DormandPrince8::advance(const double *y0, const double *f0, double h) {
  beginStep(y0, f0, h);
  if (!solveStages<nodes, weights>(*dynamics_, t0_, std::make_index_sequence<stageCount - 1>()))
    return false;
  combine<result, 0, stageCount>(end_.data());
  // The rate at the end serves the next step as well: it is to be that of the projected state.
  if (!dynamics_->evaluateProjected(t0_ + h, end_.data(), endRate_.data(), scale_))
    return false;
  std::copy_n(endRate_.begin(), n_, stage(stageCount));
  const double *k = stages_.data();
  for (std::size_t i = 0, stride = stride_; i < stride; i += 2) {
    const Pair fives = h * weightedSum<Pair, fifth, 0>(k + i, stride, std::make_index_sequence<stageCount>());
    const Pair threes = 0.1 * h * weightedSum<Pair, third, 0>(k + i, stride, std::make_index_sequence<stageCount>());
    for (std::size_t lane = 0; lane < 2; ++lane)
      error_[i + lane] = distance_ < 1 ? errorBehindSwitch(fives[lane], threes[lane]) : dampedError(fives[lane], threes[lane]);
  }
  return true;
}

// Near the border of stability both estimates pass through zero where neither the error nor, by far, that of the dense output does: of
// y' = λ y, h λ = −5.7, they are 0.003 where these are 0.28 and 5.2. What the last stage, at the end as well, differs by grows as these do:
// 1.5 there; from h λ = −4.5 on that of the dense output is four times as much at the most.
double DormandPrince8::errorNorm(const double *scale, double tolerance) const {
  constexpr double near = 0.7, part = 0.5;
  const double norm = ExplicitMethod::errorNorm(scale, tolerance);
  if (!(stabilityRatio() > near))
    return norm;
  double difference = 0;
  for (int i = 0; i < n_; ++i)
    difference = std::max(difference, std::abs(end_[i] - point_[i]) / scale[i]);
  return std::max(norm, part * difference / tolerance);
}

void DormandPrince8::makeDense() {
  const bool good = solveStage<extraNodes, extra, 0, stageCount + 1>(*dynamics_, t0_) &&
                    solveStage<extraNodes, extra, 1, stageCount + 2>(*dynamics_, t0_) &&
                    solveStage<extraNodes, extra, 2, stageCount + 3>(*dynamics_, t0_);
  makeCoefficients<dense, storedCount>(good, std::make_index_sequence<4>());
  if (good && !holdsTolerance())
    solveInside();
  // The caller's last evaluation is that at the end.
  dynamics_->evaluate(t0_ + h_, end_.data(), point_.data());
}

// By its defect, times the step, where that is 2.4 to 11 times the error of the extension for y' = λ y, −13 ≤ h λ ≤ −1 or h |λ| ≤ 3 on the
// imaginary axis. Fast components that have died out, far below the tolerance, are amplified beyond it by steps that are not stable for
// them, inside by far more than at the end: 200 times at h λ = −13.
bool DormandPrince8::holdsTolerance() {
  constexpr double place = 0.45, largest = 40;
  defect_.resize(stride_);
  evaluateDense<coefficientCount>(place, point_.data());
  if (!dynamics_->evaluate(t0_ + place * h_, point_.data(), defect_.data()))
    return true;
  double norm = 0;
  for (int i = 0; i < n_; ++i)
    norm = std::max(norm, std::abs(h_ * defect_[i] - denseSlope<coefficientCount>(place, i)) / scale_[i]);
  return !(norm > largest * tolerance_);
}

void DormandPrince8::solveInside() {
  const std::vector<double> end = end_, endRate = endRate_, error = error_;
  const double h = h_;
  inside_.solve([&](double theta, double *state) {
    const bool isSolved = advance(begin_.data(), stage(0), theta * h);
    std::copy_n(end_.begin(), n_, state);
    return isSolved;
  });
  end_ = end;
  endRate_ = endRate;
  error_ = error;
  h_ = h;
  hasDense_ = true;
}

void DormandPrince8::interpolate(double theta, double *y) {
  if (!hasDense_)
    makeDense();
  if (inside_.isKnown())
    inside_.interpolate(theta, begin_.data(), end_.data(), y);
  else
    evaluateDense<coefficientCount>(theta, y);
}

}  // namespace tf::runtime
