#include "runtime/contact/dense_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

// Code for wider registers beside that of the base architecture. Sanitizers cannot run in the functions that choose.
#if defined(__x86_64__) && defined(__ELF__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
#define TF_WIDE __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define TF_WIDE
#endif

namespace tf::runtime {

namespace {

// As wide as registers are for sure: wider vectors, of two of them, gcc keeps in memory, and comparisons it takes apart into numbers.
constexpr int halfLanes = panelLanes / 2;
using HalfLanes = double __attribute__((vector_size(halfLanes * sizeof(double))));

struct Lanes {
  HalfLanes low, high;

  // By reference: the convention for vectors as arguments depends on the processor.
  __attribute__((always_inline)) inline Lanes &operator+=(const Lanes &other) {
    low += other.low;
    high += other.high;
    return *this;
  }
  __attribute__((always_inline)) inline Lanes &operator-=(const Lanes &other) {
    low -= other.low;
    high -= other.high;
    return *this;
  }
  __attribute__((always_inline)) inline friend Lanes operator+(const Lanes &a, const Lanes &b) { return {a.low + b.low, a.high + b.high}; }
  __attribute__((always_inline)) inline friend Lanes operator*(const Lanes &a, const Lanes &b) { return {a.low * b.low, a.high * b.high}; }
  __attribute__((always_inline)) inline friend Lanes operator*(double a, const Lanes &b) { return {a * b.low, a * b.high}; }
};

__attribute__((always_inline)) inline void load(HalfLanes &lanes, const double *from) { std::memcpy(&lanes, from, sizeof lanes); }
__attribute__((always_inline)) inline void load(Lanes &lanes, const double *from) {
  load(lanes.low, from);
  load(lanes.high, from + halfLanes);
}
__attribute__((always_inline)) inline void store(const HalfLanes &lanes, double *to) { std::memcpy(to, &lanes, sizeof lanes); }
__attribute__((always_inline)) inline void store(const Lanes &lanes, double *to) {
  store(lanes.low, to);
  store(lanes.high, to + halfLanes);
}

__attribute__((always_inline)) inline double sumOf(const Lanes &l) {
  const HalfLanes half = l.low + l.high;
  return (half[0] + half[2]) + (half[1] + half[3]);
}

__attribute__((always_inline)) inline double dotOf(const double *a, const double *b, int count) {
  Lanes sum{};
  int k = 0;
  for (; k + panelLanes <= count; k += panelLanes) {
    Lanes x, y;
    load(x, a + k);
    load(y, b + k);
    sum += x * y;
  }
  double rest = 0;
  for (; k < count; ++k)
    rest += a[k] * b[k];
  return sumOf(sum) + rest;
}

// y += factor x
__attribute__((always_inline)) inline void addOf(double factor, const double *x, double *y, int count) {
  int k = 0;
  for (; k + panelLanes <= count; k += panelLanes) {
    Lanes a, b;
    load(a, x + k);
    load(b, y + k);
    b += factor * a;
    store(b, y + k);
  }
  for (; k < count; ++k)
    y[k] += factor * x[k];
}

// y += factor Σ_k x_k column_k, of so many groups of rows.
template <int Groups>
__attribute__((always_inline)) inline void addColumnsOf(const double *matrix, int rows, int columns, double factor, const double *x,
                                                        double *y) {
  Lanes sum[Groups], column;
  for (int g = 0; g < Groups; ++g)
    load(sum[g], y + g * panelLanes);
  for (int k = 0; k < columns; ++k, matrix += rows) {
    const double scaled = factor * x[k];
    for (int g = 0; g < Groups; ++g) {
      load(column, matrix + g * panelLanes);
      sum[g] += scaled * column;
    }
  }
  for (int g = 0; g < Groups; ++g)
    store(sum[g], y + g * panelLanes);
}

__attribute__((always_inline)) inline void takeLarger(HalfLanes &largest, const HalfLanes &x) {
  const HalfLanes magnitude = x < 0 ? -x : x;
  largest = magnitude > largest ? magnitude : largest;
}

__attribute__((always_inline)) inline double largestOf(const HalfLanes &x) { return std::max(std::max(x[0], x[2]), std::max(x[1], x[3])); }

// As subtractRows, `partCount` known or not.
__attribute__((always_inline)) inline RowRest subtractAny(const double *row, const double *scale, const double *factors,
                                                          const double *const *parts, int partCount, int count, double *rest) {
  HalfLanes largest{}, ofRow{}, a, b;
  int k = 0;
  for (; k + halfLanes <= count; k += halfLanes) {
    load(a, row + k);
    load(b, scale + k);
    a *= b;
    takeLarger(ofRow, a);
    for (int i = 0; i < partCount; ++i) {
      load(b, parts[i] + k);
      a -= factors[i] * b;
    }
    takeLarger(largest, a);
    store(a, rest + k);
  }
  RowRest result{largestOf(largest), largestOf(ofRow)};
  for (; k < count; ++k) {
    double value = row[k] * scale[k];
    result.ofRow = std::max(result.ofRow, std::abs(value));
    for (int i = 0; i < partCount; ++i)
      value -= factors[i] * parts[i][k];
    result.largest = std::max(result.largest, std::abs(value));
    rest[k] = value;
  }
  return result;
}

// x ← H_k x
__attribute__((always_inline)) inline void reflectByOne(const double *matrix, int rows, int k, double scale, double *x) {
  const double *v = matrix + static_cast<std::ptrdiff_t>(k) * rows + k;
  addOf(-scale * dotOf(v, x + k, rows - k), v, x + k, rows - k);
}

// x ← H_{k+1} H_k x, or (`reverse`) H_k H_{k+1} x, with x read and written once for both.
__attribute__((always_inline)) inline void reflectByTwo(const double *matrix, int rows, int k, const double *scale, double cross,
                                                        bool reverse, double *x) {
  const double *v = matrix + static_cast<std::ptrdiff_t>(k) * rows + k + 1, *w = v + rows;
  const int count = rows - k - 1;
  x += k + 1;
  Lanes sumV{}, sumW{}, a, b, c;
  int i = 0;
  for (; i + panelLanes <= count; i += panelLanes) {
    load(a, v + i);
    load(b, w + i);
    load(c, x + i);
    sumV += a * c;
    sumW += b * c;
  }
  double alongV = v[-1] * x[-1], alongW = 0;
  for (; i < count; ++i) {
    alongV += v[i] * x[i];
    alongW += w[i] * x[i];
  }
  alongV += sumOf(sumV);
  alongW += sumOf(sumW);
  double byV = -scale[k] * alongV, byW = -scale[k + 1] * alongW;
  if (reverse)
    byV = -scale[k] * (alongV + byW * cross);
  else
    byW = -scale[k + 1] * (alongW + byV * cross);
  x[-1] += byV * v[-1];
  for (i = 0; i + panelLanes <= count; i += panelLanes) {
    load(a, v + i);
    load(b, w + i);
    load(c, x + i);
    c += byV * a + byW * b;
    store(c, x + i);
  }
  for (; i < count; ++i)
    x[i] += byV * v[i] + byW * w[i];
}

// As reflectByTwo, of reflectionWidth columns at once: the sums of one would be waited for.
__attribute__((always_inline)) inline void reflectColumnsByTwo(const double *matrix, int rows, int k, const double *scale, double cross,
                                                               double *columns) {
  const double *v = matrix + static_cast<std::ptrdiff_t>(k) * rows + k + 1, *w = v + rows;
  const int count = rows - k - 1;
  double *x[reflectionWidth], byV[reflectionWidth], byW[reflectionWidth];
  Lanes sumV[reflectionWidth] = {}, sumW[reflectionWidth] = {}, a, b, c;
  for (int j = 0; j < reflectionWidth; ++j)
    x[j] = columns + static_cast<std::ptrdiff_t>(j) * rows + k + 1;
  int i = 0;
  for (; i + panelLanes <= count; i += panelLanes) {
    load(a, v + i);
    load(b, w + i);
    for (int j = 0; j < reflectionWidth; ++j) {
      load(c, x[j] + i);
      sumV[j] += a * c;
      sumW[j] += b * c;
    }
  }
  for (int j = 0; j < reflectionWidth; ++j) {
    double alongV = v[-1] * x[j][-1], alongW = 0;
    for (int rest = i; rest < count; ++rest) {
      alongV += v[rest] * x[j][rest];
      alongW += w[rest] * x[j][rest];
    }
    byV[j] = -scale[k] * (alongV + sumOf(sumV[j]));
    byW[j] = -scale[k + 1] * (alongW + sumOf(sumW[j]) + byV[j] * cross);
    x[j][-1] += byV[j] * v[-1];
  }
  for (i = 0; i + panelLanes <= count; i += panelLanes) {
    load(a, v + i);
    load(b, w + i);
    for (int j = 0; j < reflectionWidth; ++j) {
      load(c, x[j] + i);
      c += byV[j] * a + byW[j] * b;
      store(c, x[j] + i);
    }
  }
  for (int j = 0; j < reflectionWidth; ++j)
    for (int rest = i; rest < count; ++rest)
      x[j][rest] += byV[j] * v[rest] + byW[j] * w[rest];
}

// Of a panel's columns from `panel` on: rows before the first one that is not zero in all of panelLanes columns.
__attribute__((always_inline)) inline int leadingZeroRows(const double *panel, int depth, int stride) {
  int k = 0;
  for (bool isZero = true; k < depth; ++k, panel += stride) {
    for (int lane = 0; lane < panelLanes; ++lane)
      isZero &= panel[lane] == 0;
    if (!isZero)
      break;
  }
  return k;
}

// Of the first entry with the largest magnitude.
__attribute__((always_inline)) inline int placeOfLargest(const double *x, int count) {
  HalfLanes largest{}, a;
  int k = 0;
  for (; k + halfLanes <= count; k += halfLanes) {
    load(a, x + k);
    takeLarger(largest, a);
  }
  double most = largestOf(largest);
  for (; k < count; ++k)
    most = std::max(most, std::abs(x[k]));
  int place = 0;
  while (place + 1 < count && !(std::abs(x[place]) >= most))
    ++place;
  return place;
}

// `count` columns of a size × size matrix less their parts along four columns of L, next to each other from `pivots` on, of which the first
// one has its unit entry in row k.
template <int count> __attribute__((always_inline)) inline void eliminateFour(const double *pivots, int k, int size, double *columns) {
  const double *l0 = pivots, *l1 = l0 + size, *l2 = l1 + size, *l3 = l2 + size;
  double a[count], b[count], c[count], d[count];
  for (int j = 0; j < count; ++j) {
    double *x = columns + static_cast<std::ptrdiff_t>(j) * size + k;
    a[j] = x[0];
    b[j] = x[1] -= a[j] * l0[k + 1];
    c[j] = x[2] -= a[j] * l0[k + 2] + b[j] * l1[k + 2];
    d[j] = x[3] -= a[j] * l0[k + 3] + b[j] * l1[k + 3] + c[j] * l2[k + 3];
  }
  int i = k + 4;
  for (; i + panelLanes <= size; i += panelLanes) {
    Lanes x0, x1, x2, x3;
    load(x0, l0 + i);
    load(x1, l1 + i);
    load(x2, l2 + i);
    load(x3, l3 + i);
    for (int j = 0; j < count; ++j) {
      double *place = columns + static_cast<std::ptrdiff_t>(j) * size + i;
      Lanes rest;
      load(rest, place);
      rest -= (a[j] * x0 + b[j] * x1) + (c[j] * x2 + d[j] * x3);
      store(rest, place);
    }
  }
  for (; i < size; ++i)
    for (int j = 0; j < count; ++j)
      columns[static_cast<std::ptrdiff_t>(j) * size + i] -= (a[j] * l0[i] + b[j] * l1[i]) + (c[j] * l2[i] + d[j] * l3[i]);
}

}  // namespace

TF_WIDE double denseDot(const double *a, const double *b, int count) { return dotOf(a, b, count); }

// The sums are those of dotOf.
TF_WIDE void subtractProduct(const double *matrix, int rows, int columns, const double *x, double *y) {
  constexpr int height = 4;
  int i = 0;
  for (; i + height <= rows; i += height) {
    const double *row = matrix + static_cast<std::ptrdiff_t>(i) * columns;
    Lanes sum[height] = {}, a, b;
    double rest[height] = {};
    int k = 0;
    for (; k + panelLanes <= columns; k += panelLanes) {
      load(b, x + k);
      for (int h = 0; h < height; ++h) {
        load(a, row + static_cast<std::ptrdiff_t>(h) * columns + k);
        sum[h] += a * b;
      }
    }
    for (; k < columns; ++k)
      for (int h = 0; h < height; ++h)
        rest[h] += row[static_cast<std::ptrdiff_t>(h) * columns + k] * x[k];
    for (int h = 0; h < height; ++h)
      y[i + h] -= sumOf(sum[h]) + rest[h];
  }
  for (; i < rows; ++i)
    y[i] -= dotOf(matrix + static_cast<std::ptrdiff_t>(i) * columns, x, columns);
}

TF_WIDE void addManyColumns(const double *matrix, int rows, int columns, double factor, const double *x, double *y) {
  constexpr int groups = 4;
  if (columns == 0)
    return;  // there is no matrix
  int r = 0;
  for (; r + groups * panelLanes <= rows; r += groups * panelLanes)
    addColumnsOf<groups>(matrix + r, rows, columns, factor, x, y + r);
  if (r + 2 * panelLanes <= rows) {
    addColumnsOf<2>(matrix + r, rows, columns, factor, x, y + r);
    r += 2 * panelLanes;
  }
  if (r + panelLanes <= rows) {
    addColumnsOf<1>(matrix + r, rows, columns, factor, x, y + r);
    r += panelLanes;
  }
  for (int k = 0; k < columns && r < rows; ++k) {
    const double *column = matrix + static_cast<std::ptrdiff_t>(k) * rows, scaled = factor * x[k];
    for (int i = r; i < rows; ++i)
      y[i] += scaled * column[i];
  }
}

TF_WIDE double dotAndAdd(const double *row, const double *x, double factor, double *y, int count) {
  const double sum = dotOf(row, x, count);
  if (factor != 0)
    addOf(factor, row, y, count);
  return sum;
}

TF_WIDE double copyAndWeigh(const double *x, const double *weight, int count, double *y) {
  Lanes sum{}, a, b;
  int k = 0;
  for (; k + panelLanes <= count; k += panelLanes) {
    load(a, x + k);
    load(b, weight + k);
    store(a, y + k);
    sum += a * b;
  }
  double rest = 0;
  for (; k < count; ++k) {
    y[k] = x[k];
    rest += x[k] * weight[k];
  }
  return sumOf(sum) + rest;
}

TF_WIDE int firstWithin(const double *values, int begin, int end, double x, double accepted) {
  int k = begin;
  for (; k + halfLanes <= end; k += halfLanes) {
    HalfLanes a;
    load(a, values + k);
    a -= x;
    const HalfLanes magnitude = a < 0 ? -a : a;
    const auto isWithin = magnitude <= accepted;
    if ((isWithin[0] | isWithin[1]) | (isWithin[2] | isWithin[3]))
      break;
  }
  while (k < end && !(std::abs(values[k] - x) <= accepted))
    ++k;
  return k;
}

TF_WIDE Difference largestDifference(const double *x, const double *y, int count) {
  HalfLanes largest{}, ofFirst{}, a, b;
  int k = 0;
  for (; k + halfLanes <= count; k += halfLanes) {
    load(a, x + k);
    load(b, y + k);
    takeLarger(ofFirst, a);
    a -= b;
    takeLarger(largest, a);
  }
  Difference result{largestOf(largest), largestOf(ofFirst)};
  for (; k < count; ++k) {
    result.largest = std::max(result.largest, std::abs(x[k] - y[k]));
    result.ofFirst = std::max(result.ofFirst, std::abs(x[k]));
  }
  return result;
}

TF_WIDE RowRest subtractRows(const double *row, const double *scale, const double *factors, const double *const *parts, int partCount,
                             int count, double *rest) {
  switch (partCount) {
  case 2:
    return subtractAny(row, scale, factors, parts, 2, count, rest);
  case 3:
    return subtractAny(row, scale, factors, parts, 3, count, rest);
  default:
    return subtractAny(row, scale, factors, parts, partCount, count, rest);
  }
}

TF_WIDE void reflectColumns(double *matrix, int rows, int j, const double *scale, const double *cross) {
  for (int k = 0; k + 1 < j; k += 2)
    reflectColumnsByTwo(matrix, rows, k, scale, cross[k + 1], matrix + static_cast<std::ptrdiff_t>(j) * rows);
}

TF_WIDE bool reflectColumn(double *matrix, int rows, int j, double dependence, double *scale, double *cross, double &diagonal, int from) {
  double *x = matrix + static_cast<std::ptrdiff_t>(j) * rows;
  int k = from;
  for (; k + 1 < j; k += 2)
    reflectByTwo(matrix, rows, k, scale, cross[k + 1], false, x);
  if (k < j)
    reflectByOne(matrix, rows, k, scale[k], x);
  const double length = std::sqrt(dotOf(x + j, x + j, rows - j));
  if (!(length > dependence))
    return false;
  diagonal = x[j] > 0 ? -length : length;
  scale[j] = 1 / (length * (length + std::abs(x[j])));
  x[j] -= diagonal;
  cross[j] = j % 2 == 1 ? dotOf(x - rows + j, x + j, rows - j) : 0.0;
  return true;
}

TF_WIDE void applyReflections(const double *matrix, int rows, int columns, const double *scale, const double *cross, double *x) {
  int k = columns - 1;
  if (columns % 2 == 1)
    reflectByOne(matrix, rows, k--, scale[columns - 1], x);
  for (; k >= 1; k -= 2)
    reflectByTwo(matrix, rows, k - 1, scale, cross[k], true, x);
}

TF_WIDE void multiplyPanels(const double *z, const double *s, int depth, int stride, double *product) {
  constexpr int height = 4;
  for (int j = 0; j < stride; j += panelLanes) {
    const int from = leadingZeroRows(s + j, depth, stride);
    for (int i = j; i < stride; i += height) {
      Lanes sum0{}, sum1{}, sum2{}, sum3{};
      for (int k = from; k < depth; ++k) {
        const double *left = z + static_cast<std::ptrdiff_t>(k) * stride + i;
        Lanes right;
        load(right, s + static_cast<std::ptrdiff_t>(k) * stride + j);
        sum0 += left[0] * right;
        sum1 += left[1] * right;
        sum2 += left[2] * right;
        sum3 += left[3] * right;
      }
      double *out = product + static_cast<std::ptrdiff_t>(i) * stride + j;
      store(sum0, out);
      store(sum1, out + stride);
      store(sum2, out + 2 * static_cast<std::ptrdiff_t>(stride));
      store(sum3, out + 3 * static_cast<std::ptrdiff_t>(stride));
    }
  }
}

// Four rows at a time, so that those above are read once for them.
TF_WIDE void forwardPanel(const double *factor, const std::ptrdiff_t *start, const int *first, int begin, int end, int stride, double *z) {
  constexpr int height = 4;
  for (int j = 0; j < stride; j += panelLanes) {
    const auto rowOf = [=](int k) __attribute__((always_inline)) { return z + static_cast<std::ptrdiff_t>(k - begin) * stride + j; };
    const int zeros = begin + leadingZeroRows(z + j, end - begin, stride);
    int i = zeros;
    for (; i + height <= end; i += height) {
      const double *row[height];
      Lanes sum[height] = {}, x;
      // From where on all of them have entries.
      int from = std::max(zeros, first[i]);
      for (int r = 0; r < height; ++r) {
        row[r] = factor + start[i + r];
        from = std::max(from, std::min(first[i + r], i));
      }
      for (int r = 0; r < height; ++r)
        for (int k = std::max(zeros, first[i + r]); k < from; ++k) {
          load(x, rowOf(k));
          sum[r] += row[r][k] * x;
        }
      for (int k = from; k < i; ++k) {
        load(x, rowOf(k));
        for (int r = 0; r < height; ++r)
          sum[r] += row[r][k] * x;
      }
      Lanes own[height];
      for (int r = 0; r < height; ++r) {
        load(own[r], rowOf(i + r));
        own[r] -= sum[r];
        for (int k = 0; k < r; ++k)
          if (i + k >= first[i + r])
            own[r] -= row[r][i + k] * own[k];
        store(own[r], rowOf(i + r));
      }
    }
    for (; i < end; ++i) {
      const double *row = factor + start[i];
      Lanes sum{}, x;
      for (int k = std::max(zeros, first[i]); k < i; ++k) {
        load(x, rowOf(k));
        sum += row[k] * x;
      }
      load(x, rowOf(i));
      x -= sum;
      store(x, rowOf(i));
    }
  }
}

// Four columns at a time, at first the square on the diagonal, then what is below it, and then row by row the rest of the matrix, which is
// read and written once for them.
TF_WIDE int factoriseDense(double *matrix, int size, int stride, double singular, double *inverse, double *work) {
  constexpr int width = 4;
  const auto row = [matrix, stride](int i) __attribute__((always_inline)) { return matrix + static_cast<std::ptrdiff_t>(i) * stride; };
  for (int i = 0; i < size; ++i)
    inverse[i] = std::abs(row(i)[i]);
  double *w0 = work, *w1 = w0 + stride, *w2 = w1 + stride, *w3 = w2 + stride;
  for (int begin = 0; begin < size; begin += width) {
    const int end = std::min(begin + width, size);
    for (int k = begin; k < end; ++k) {
      const double pivot = row(k)[k];
      if (!(pivot > singular * inverse[k]))
        return k;
      inverse[k] = 1 / pivot;
      double *unscaled = work + static_cast<std::ptrdiff_t>(k - begin) * stride;
      for (int i = k + 1; i < end; ++i) {
        unscaled[i] = row(i)[k];
        const double scaled = unscaled[i] * inverse[k];
        row(i)[k] = scaled;
        for (int j = k + 1; j <= i; ++j)
          row(i)[j] -= scaled * unscaled[j];
      }
    }
    if (end < begin + width)
      break;
    const double *factors = inverse + begin, *u0 = w0 + begin, *u1 = w1 + begin, *u2 = w2 + begin;
    for (int i = end; i < size; ++i) {
      double *own = row(i) + begin;
      const double unscaled0 = own[0], a = unscaled0 * factors[0];
      const double unscaled1 = own[1] - a * u0[1], b = unscaled1 * factors[1];
      const double unscaled2 = own[2] - a * u0[2] - b * u1[2], c = unscaled2 * factors[2];
      const double unscaled3 = own[3] - a * u0[3] - b * u1[3] - c * u2[3], d = unscaled3 * factors[3];
      w0[i] = unscaled0;
      w1[i] = unscaled1;
      w2[i] = unscaled2;
      w3[i] = unscaled3;
      own[0] = a;
      own[1] = b;
      own[2] = c;
      own[3] = d;
    }
    for (int i = end; i < size; ++i) {
      double *target = row(i);
      const double a = target[begin], b = target[begin + 1], c = target[begin + 2], d = target[begin + 3];
      const auto eliminate = [=]<class T>(std::type_identity<T> /*lanes*/, int j) __attribute__((always_inline)) {
        T rest, x0, x1, x2, x3;
        load(rest, target + j);
        load(x0, w0 + j);
        load(x1, w1 + j);
        load(x2, w2 + j);
        load(x3, w3 + j);
        rest -= (a * x0 + b * x1) + (c * x2 + d * x3);
        store(rest, target + j);
      };
      int j = end;
      if (j % panelLanes != 0) {
        eliminate(std::type_identity<HalfLanes>{}, j);
        j += width;
      }
      for (; j <= i; j += panelLanes)
        eliminate(std::type_identity<Lanes>{}, j);
    }
  }
  return -1;
}

TF_WIDE int factoriseSemidefinite(double *matrix, int size, double dependence, int *order) {
  const auto entry = [matrix, size](int i, int j)
                         __attribute__((always_inline)) -> double & { return matrix[static_cast<std::ptrdiff_t>(j) * size + i]; };
  for (int k = 0; k < size; ++k) {
    int best = k;
    for (int i = k + 1; i < size; ++i)
      if (entry(i, i) > entry(best, best) * (1 + 1e-12))
        best = i;
    if (!(entry(best, best) > dependence))
      return k;
    if (best != k) {
      std::swap(order[k], order[best]);
      std::swap(entry(k, k), entry(best, best));
      for (int j = 0; j < k; ++j)
        std::swap(entry(k, j), entry(best, j));
      for (int i = k + 1; i < best; ++i)
        std::swap(entry(i, k), entry(best, i));
      for (int i = best + 1; i < size; ++i)
        std::swap(entry(i, k), entry(i, best));
    }
    const double root = std::sqrt(entry(k, k)), inverse = 1 / root;
    entry(k, k) = root;
    for (int i = k + 1; i < size; ++i)
      entry(i, k) *= inverse;
    for (int j = k + 1; j < size; ++j)
      if (entry(j, k) != 0)
        addOf(-entry(j, k), &entry(j, k), &entry(j, j), size - j);
  }
  return size;
}

TF_WIDE void backwardRows(const double *factor, const std::ptrdiff_t *start, const int *first, int begin, int end, double *x) {
  for (int i = end - 1; i > begin; --i)
    addOf(-x[i], factor + start[i] + first[i], x + first[i], i - first[i]);
}

// Four columns at a time: the rest of the matrix is read and written once for them.
TF_WIDE bool factoriseLu(double *matrix, int size, double singular, int *pivot) {
  constexpr int width = 4;
  const auto columnAt = [matrix, size](int j) __attribute__((always_inline)) { return matrix + static_cast<std::ptrdiff_t>(j) * size; };
  for (int begin = 0; begin < size; begin += width) {
    const int end = std::min(begin + width, size);
    for (int k = begin; k < end; ++k) {
      double *column = columnAt(k);
      const int best = k + placeOfLargest(column + k, size - k);
      pivot[k] = best;
      const double magnitude = std::abs(column[best]);
      if (!(magnitude > singular) || !std::isfinite(magnitude))
        return false;
      for (int j = 0; best != k && j < size; ++j)
        std::swap(columnAt(j)[k], columnAt(j)[best]);
      const double inverse = 1 / column[k];
      for (int i = k + 1; i < size; ++i)
        column[i] *= inverse;
      for (int j = k + 1; j < end; ++j)
        addOf(-columnAt(j)[k], column + k + 1, columnAt(j) + k + 1, size - k - 1);
    }
    // Rows of bodies apart have no entries in common: nothing comes to these columns.
    const auto isApart = [&](int j) __attribute__((always_inline)) {
      return std::all_of(columnAt(j) + begin, columnAt(j) + end, [](double entry) { return entry == 0; });
    };
    int j = end;
    for (; j + 2 <= size; j += 2)
      if (!isApart(j) || !isApart(j + 1))
        eliminateFour<2>(columnAt(begin), begin, size, columnAt(j));
    if (j < size && !isApart(j))
      eliminateFour<1>(columnAt(begin), begin, size, columnAt(j));
  }
  return true;
}

TF_WIDE void solveLu(const double *matrix, int size, const int *pivot, double *b) {
  for (int k = 0; k < size; ++k)
    std::swap(b[k], b[pivot[k]]);
  for (int k = 0; k < size; ++k)
    addOf(-b[k], matrix + static_cast<std::ptrdiff_t>(k) * size + k + 1, b + k + 1, size - k - 1);
  for (int k = size - 1; k >= 0; --k) {
    const double *column = matrix + static_cast<std::ptrdiff_t>(k) * size;
    b[k] /= column[k];
    addOf(-b[k], column, b, k);
  }
}

}  // namespace tf::runtime
