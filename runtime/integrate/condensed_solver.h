// The linear systems of implicit multistep methods for q' = v, v' = f(q, v, z, …): I − γ J has unit rows (1, −γ) for the coordinates, which
// are eliminated before the rest is factorised, an eighth of the work.
#pragma once

#include <sundials/sundials_linearsolver.h>

namespace tf::runtime {

// For dense matrices of which the first `coordinates` rows are those of q' = v, v the next ones in the same order. Null: no memory.
SUNLinearSolver makeCondensedSolver(int coordinates, int size, SUNContext context);

}  // namespace tf::runtime
