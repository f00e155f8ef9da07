#include "runtime/integrate/rock2_tableau.h"

#include <cmath>

namespace tf::runtime {

namespace {

// Zeros re ± i im of w, and the interval on which the P are orthogonal. They solve four equations: the product has the derivatives 1, 1 of
// the exponential function at zero, and the amplitude 0.95 both at −length and at its first maximum on the left of zero. (Newton's method
// in 40 digits.)
struct StabilityPolynomial {
  int stages;
  double re, im, begin, length;
};

constexpr StabilityPolynomial polynomials[] = {
    {3, -1.1630761032421, 1.2174409771943, 1.4459702422446, 6.1431916033887},
    {4, -1.2322627829575, 1.2828833787457, 1.8144915791396, 11.832220643522},
    {5, -1.2664732865243, 1.3116867759072, 1.9779516920725, 19.117779495592},
    {6, -1.2856565775098, 1.326942798259, 2.0665737116487, 28.012681588903},
    {7, -1.2974314807067, 1.336008232706, 2.1201198707772, 38.520612637121},
    {8, -1.3051585489438, 1.3418380048472, 2.1549491663111, 50.642994775277},
    {9, -1.3104950165584, 1.3458101823582, 2.1788705937853, 64.380478158335},
    {10, -1.3143316298646, 1.3486390902218, 2.1960052478023, 79.733395995276},
    {11, -1.3171807795642, 1.3507255052127, 2.2086966549519, 96.701933914262},
    {12, -1.3193537808962, 1.3523085963984, 2.2183576878517, 115.28620216747},
    {13, -1.3210484749042, 1.3535383389906, 2.2258812974609, 135.48626966032},
    {14, -1.3223954008603, 1.3545126836619, 2.2318542777797, 157.30218128614},
    {15, -1.323483477113, 1.355297819574, 2.2366750936835, 180.73396732531},
    {16, -1.3243749490999, 1.3559397867947, 2.2406220081089, 205.78164881033},
    {17, -1.3251144355695, 1.3564714178058, 2.2438941011583, 232.44524072313},
    {18, -1.3257345908533, 1.3569166394146, 2.2466368425069, 260.72475397196},
    {19, -1.3262597550211, 1.3572932234962, 2.2489585238435, 290.62019665298},
    {20, -1.3267083688577, 1.3576145946775, 2.2509411024567, 322.13157487816},
    {22, -1.3274295176498, 1.3581305826829, 2.2541267924091, 390.0021556535},
    {24, -1.3279783883556, 1.3585227945968, 2.25655035952, 464.33652276315},
    {26, -1.3284057648754, 1.3588278845739, 2.2584368189288, 545.13469286604},
    {28, -1.328745015899, 1.3590698749667, 2.2599338885357, 632.39667687448},
    {30, -1.3290187971645, 1.3592650429515, 2.2611417915275, 726.1224821796},
    {33, -1.3293400415708, 1.3594939063512, 2.2625588061761, 878.83086591889},
    {36, -1.3295844490684, 1.3596679283967, 2.2636366810007, 1046.0828705001},
    {40, -1.3298288148875, 1.3598418338966, 2.264714190233, 1291.7089658068},
};

// Weights of a stage by the trees t and [t], and of one more tree of order 3, [[t]].
struct StageWeights {
  double leaf = 0, tall2 = 0, tall3 = 0;
};

StageWeights plus(const StageWeights &g, double weight, const StageWeights &at) {
  return {g.leaf + weight, g.tall2 + weight * at.leaf, g.tall3 + weight * at.tall2};
}

Rock2Tableau makeTableau(const StabilityPolynomial &polynomial) {
  const auto [stages, re, im, begin, length] = polynomial;
  const double constant = re * re + im * im;
  Rock2Tableau tableau;
  tableau.stages = stages;
  tableau.border = length;
  makeRecurrence(
      stages - Rock2Tableau::lastStages, begin, length, [&](double x) { return ((x - re) * (x - re) + im * im) / constant; }, tableau);
  StageWeights before, last;
  for (std::size_t j = 0; j < tableau.mu.size(); ++j) {
    const double mu = tableau.mu[j], kappa = tableau.kappa[j];
    const StageWeights sum = {last.leaf + kappa * (last.leaf - before.leaf), last.tall2 + kappa * (last.tall2 - before.tall2),
                              last.tall3 + kappa * (last.tall3 - before.tall3)};
    const StageWeights next = plus(sum, mu, last);
    before = last;
    last = next;
    tableau.node.push_back(last.leaf);
  }
  // w(x) = 1 + 2 σ x + τ x²
  const double sigma = -re / constant, tau = 1 / constant;
  const StageWeights second = plus(last, sigma, last);
  tableau.weight = sigma;
  tableau.lastNode = {last.leaf, second.leaf};
  tableau.result = {2 * sigma - tau / sigma, tau / sigma};
  const StageWeights end = plus(plus(last, tableau.result[0], last), tableau.result[1], second);
  // The weights that leave out all trees of order up to 2 are multiples of one set of weights: that with the error's factor of [[t]].
  const double ofBefore = -(second.leaf - last.leaf) / (before.leaf - last.leaf);
  const double unit = ofBefore * before.tall2 + second.tall2 - (1 + ofBefore) * last.tall2;
  const double factor = (end.tall3 - 1.0 / 6) / unit;
  tableau.error = {factor * ofBefore, -factor * (1 + ofBefore), factor};
  return tableau;
}

}  // namespace

const std::vector<Rock2Tableau> &rock2Tableaus() {
  static const std::vector<Rock2Tableau> tableaus = makeTableaus(polynomials, makeTableau);
  return tableaus;
}

}  // namespace tf::runtime
