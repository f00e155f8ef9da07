#include "runtime/integrate/rock4_tableau.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

constexpr int lastStages = Rock4Tableau::lastStages;

// Zeros re ± i im of w, and the interval on which the P are orthogonal. They solve six equations: the product has the derivatives 1, 1, 1,
// 1 of the exponential function at zero, and the amplitude 0.95 both at −length and at its first maximum on the left of zero. (Newton's
// method in 18 digits; those of Abdulle's programs were found by other conditions and differ a little.)
struct StabilityPolynomial {
  int stages;
  double re1, im1, re2, im2, begin, length;
};

constexpr StabilityPolynomial polynomials[] = {
    {5, -2.0113581655065, 1.0868822539124, -0.22193395027669, 2.8562320739495, 2.9184795772961, 5.9982689347933},
    {6, -2.1601154446875, 1.1681790016522, -0.21977029023526, 3.0619757717004, 3.4394584840988, 9.8760270418687},
    {7, -2.2493418663547, 1.2117449532647, -0.22851951301069, 3.1925045583386, 3.7583956015183, 14.458006021635},
    {8, -2.3072900038076, 1.2382295333149, -0.23901083060067, 3.2799795365348, 3.9695193607807, 19.749301116459},
    {9, -2.3471095753315, 1.2556632816735, -0.24866853600418, 3.3412170321934, 4.1166839976906, 25.749778123236},
    {10, -2.3756653958835, 1.2677991229648, -0.25691229319037, 3.3856460788707, 4.2233398265724, 32.4588159713},
    {11, -2.3968443520823, 1.2766081941498, -0.2637722879619, 3.4188501364878, 4.3030704400046, 39.875904290193},
    {12, -2.4129868695481, 1.283215112769, -0.26944221818088, 3.4442905475286, 4.3642082586305, 48.00068177217},
    {13, -2.4255724672729, 1.2883028201736, -0.2741342561017, 3.4641987684529, 4.4120987510748, 56.832899289852},
    {14, -2.4355742815102, 1.2923068774224, -0.27803582637639, 3.480062688321, 4.450299065834, 66.372384243419},
    {15, -2.4436539078085, 1.295516323784, -0.28130093098296, 3.4929038114759, 4.481250207761, 76.619015310314},
    {16, -2.4502739446441, 1.2981293841819, -0.28405255582941, 3.5034415544461, 4.5066718774377, 87.572705728261},
    {17, -2.4557657607255, 1.3002858332133, -0.28638790654919, 3.5121940540874, 4.5278035471257, 99.233392357456},
    {18, -2.4603717709324, 1.3020866056747, -0.28838367859064, 3.5195419417614, 4.5455565943544, 111.60102847544},
    {19, -2.4642726283506, 1.303606110848, -0.29010054365924, 3.5257698011581, 4.5606130975308, 124.67557896562},
    {20, -2.4676051876902, 1.3049002060789, -0.29158673279484, 3.5310937817476, 4.5734916288828, 138.4570170522},
    {21, -2.4704746551075, 1.3060114994454, -0.29288081971322, 3.5356803965124, 4.5845920582999, 152.94532204776},
    {22, -2.4729629800119, 1.3069729599676, -0.29401385795867, 3.5396595724711, 4.5942266789889, 168.14047777398},
    {23, -2.4751347611445, 1.3078104272625, -0.29501101625578, 3.543133873853, 4.6026422226933, 184.04247143734},
    {24, -2.477041474227, 1.308544388912, -0.29589283113682, 3.5461851267121, 4.6100356863675, 200.65129281699},
    {26, -2.4802176144344, 1.3097643212966, -0.29737497375246, 3.5512698130353, 4.6223619639622, 235.98938729139},
    {28, -2.4827391235815, 1.3107304371681, -0.29856345641695, 3.5553082378703, 4.6321570307599, 274.15471179747},
    {30, -2.4847742240632, 1.3115086541356, -0.29953033152812, 3.5585687240435, 4.6400686324807, 315.14723270165},
    {32, -2.4864403929958, 1.3121447758131, -0.30032703121006, 3.5612388418269, 4.6465500071059, 358.96692647162},
    {35, -2.4884253565485, 1.3129014158797, -0.30128217810617, 3.5644206543097, 4.6542762186319, 429.99738064862},
    {38, -2.4899595559226, 1.313485343239, -0.30202490894737, 3.5668805015864, 4.6602514161878, 507.38889763073},
    {41, -2.4911697946993, 1.313945423373, -0.30261357110011, 3.5688212849393, 4.6649670659069, 591.14145192092},
    {44, -2.4921412392856, 1.3143143766022, -0.3030878508479, 3.5703793525087, 4.668753649309, 681.25502637983},
    {48, -2.4931642887667, 1.3147025947724, -0.30358902900182, 3.5720203993484, 4.6727427181429, 811.30135926772},
    {52, -2.4939606058486, 1.3150045370943, -0.30398034508153, 3.5732978992053, 4.6758486617489, 952.65613261559},
    {56, -2.4945925491552, 1.3152440054617, -0.30429164187987, 3.5743117921987, 4.6783140753701, 1105.3193338536},
    {60, -2.4951024270521, 1.3154371231329, -0.30454329645624, 3.5751299012849, 4.680303654049, 1269.2909544505},
};

// Trees of order up to 4, by which conditions of order are numbered (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I,
// II.2): t, [t], [[t]], [t t], [[[t]]], [t [t]], [[t t]], [t t t].
enum Tree { Leaf, Tall2, Tall3, Bush3, Tall4, Mixed4, Fork4, Bush4, treeCount };
using TreeWeights = std::array<double, treeCount>;
constexpr TreeWeights exact = {1, 1.0 / 2, 1.0 / 6, 1.0 / 3, 1.0 / 24, 1.0 / 8, 1.0 / 12, 1.0 / 4};

// Of h f(g), where g is a stage with the given weights.
TreeWeights ofRate(const TreeWeights &g) {
  return {1, g[Leaf], g[Tall2], g[Leaf] * g[Leaf], g[Tall3], g[Leaf] * g[Tall2], g[Bush3], g[Leaf] * g[Leaf] * g[Leaf]};
}

// Solution of a system of `count` linear equations, `row` of which has its right-hand side at [row][count].
template <std::size_t count> std::array<double, count> solve(std::array<std::array<double, count + 1>, count> rows) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto pivot =
        std::max_element(rows.begin() + i, rows.end(), [i](const auto &a, const auto &b) { return std::abs(a[i]) < std::abs(b[i]); });
    std::swap(rows[i], *pivot);
    for (std::size_t r = 0; r < count; ++r)
      if (const double factor = rows[r][i] / rows[i][i]; r != i)
        for (std::size_t c = i; c <= count; ++c)
          rows[r][c] -= factor * rows[i][c];
  }
  std::array<double, count> result;
  for (std::size_t i = 0; i < count; ++i)
    result[i] = rows[i][count] / rows[i][i];
  return result;
}

// Weights of the last g and, into `before`, of the one before; the times of all.
TreeWeights recurrenceWeights(Rock4Tableau &tableau, TreeWeights &before) {
  TreeWeights last{};
  before.fill(0);
  for (std::size_t j = 0; j < tableau.mu.size(); ++j) {
    const TreeWeights rate = ofRate(last);
    TreeWeights next;
    for (int k = 0; k < treeCount; ++k)
      next[k] = tableau.mu[j] * rate[k] + (1 + tableau.kappa[j]) * last[k] - tableau.kappa[j] * before[k];
    before = last;
    last = next;
    tableau.node.push_back(last[Leaf]);
  }
  return last;
}

// The last stages with the second node at a distance of `second` from the first, third and fourth at one and two thirds of the rest of the
// step: seven conditions of order 4 are linear equations in their turn. Returns what is left of the eighth, of [[[t]]].
double makeLastStages(const TreeWeights &g, double second, Rock4Tableau &tableau) {
  const double first = g[Leaf], third = (1 - first) / 3, fourth = 2 * third;
  const std::array<double, lastStages> c = {first, first + second, first + third, first + fourth};
  tableau.lastNode = c;
  const std::array<double, lastStages> b =
      solve<4>({{{1, 1, 1, 1, exact[Leaf] - g[Leaf]},
                 {c[0], c[1], c[2], c[3], exact[Tall2] - g[Tall2]},
                 {c[0] * c[0], c[1] * c[1], c[2] * c[2], c[3] * c[3], exact[Bush3] - g[Bush3]},
                 {std::pow(c[0], 3), std::pow(c[1], 3), std::pow(c[2], 3), std::pow(c[3], 3), exact[Bush4] - g[Bush4]}}});
  tableau.result = b;
  // Sums over b_i and b_i c_i, alone and with c_i − c_1.
  const double sum = exact[Leaf] - g[Leaf], sumC = exact[Tall2] - g[Tall2], sumOfC = sumC - first * sum;
  const double sumCOfC = exact[Bush3] - g[Bush3] - first * sumC;
  // Σ b_i a_ij (c_j − c_1), Σ b_i c_i a_ij (c_j − c_1), Σ b_i a_ij (c_j² − c_1²)
  const double tall = exact[Tall3] - g[Tall3] - g[Tall2] * sum - first * sumOfC;
  const double mixed = exact[Mixed4] - g[Mixed4] - g[Tall2] * sumC - first * sumCOfC;
  const double fork = exact[Fork4] - g[Fork4] - g[Bush3] * sum - first * first * sumOfC;
  const auto [bySecond, byThird] = solve<2>({{{second, third, tall}, {c[1] * c[1] - first * first, c[2] * c[2] - first * first, fork}}});
  const double a43 = byThird / b[3];
  const auto [third2, fourth2] = solve<2>({{{1, 1, bySecond}, {c[2], c[3], (mixed - b[3] * c[3] * a43 * third) / second}}});
  const double a32 = third2 / b[2], a42 = fourth2 / b[3];
  tableau.weights = {{{}, {second}, {third - a32, a32}, {fourth - a42 - a43, a42, a43}}};
  return g[Tall3] * sum + g[Tall2] * sumOfC + first * tall + b[3] * a43 * a32 * second - (exact[Tall4] - g[Tall4]);
}

// The weights that leave out all trees of order up to 3 are multiples of one set of weights. As its stability function is x⁴ P(x) times a
// polynomial of degree 0, near enough, it is bounded on the interval as that of the method's error is, and with this factor of [[[t]]]
// about as large as that one, or a little larger, for all x.
void makeError(const TreeWeights &before, const TreeWeights &g, Rock4Tableau &tableau) {
  constexpr double ofTall4 = 0.006;
  std::array<double, lastStages> tall2, tall3;
  std::array<std::array<double, 5>, 4> rows;
  for (std::size_t i = 0; i < lastStages; ++i) {
    tall2[i] = g[Tall2];
    tall3[i] = g[Tall3];
    for (std::size_t j = 0; j < i; ++j) {
      tall2[i] += tableau.weights[i][j] * tableau.lastNode[j];
      tall3[i] += tableau.weights[i][j] * tall2[j];
    }
    const double c = tableau.lastNode[i];
    rows[0][i] = 1;
    rows[1][i] = c;
    rows[2][i] = c * c;
    rows[3][i] = tall2[i];
  }
  rows[0][4] = -1;
  rows[1][4] = -before[Leaf];
  rows[2][4] = -before[Leaf] * before[Leaf];
  rows[3][4] = -before[Tall2];
  const std::array<double, 4> last = solve<4>(rows);
  double sum = before[Tall3];
  for (std::size_t i = 0; i < lastStages; ++i)
    sum += last[i] * tall3[i];
  tableau.error[0] = ofTall4 / sum;
  for (std::size_t i = 0; i < lastStages; ++i)
    tableau.error[i + 1] = ofTall4 / sum * last[i];
}

Rock4Tableau makeTableau(const StabilityPolynomial &polynomial) {
  Rock4Tableau tableau;
  tableau.stages = polynomial.stages;
  tableau.border = polynomial.length;
  const auto w = [&polynomial](double x) {
    return (std::pow(x - polynomial.re1, 2) + std::pow(polynomial.im1, 2)) *
           (std::pow(x - polynomial.re2, 2) + std::pow(polynomial.im2, 2));
  };
  makeRecurrence(polynomial.stages - lastStages, polynomial.begin, polynomial.length, w, tableau);
  TreeWeights before;
  const TreeWeights g = recurrenceWeights(tableau, before);
  // The second node by the secant method.
  double second = -0.15, other = -0.14, otherRest = makeLastStages(g, other, tableau);
  for (int k = 0; k < 40; ++k) {
    const double rest = makeLastStages(g, second, tableau);
    if (std::abs(rest) <= 1e-17 || rest == otherRest || std::abs(second - other) <= 1e-15)
      break;
    const double next = second - rest * (second - other) / (rest - otherRest);
    other = second;
    otherRest = rest;
    second = next;
  }
  makeError(before, g, tableau);
  return tableau;
}

}  // namespace

const std::vector<Rock4Tableau> &rock4Tableaus() {
  static const std::vector<Rock4Tableau> tableaus = makeTableaus(polynomials, makeTableau);
  return tableaus;
}

}  // namespace tf::runtime
