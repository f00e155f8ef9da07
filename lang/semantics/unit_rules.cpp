#include "lang/semantics/flatten.h"
namespace tf::semantics {
void checkUnits(const flat::FlatModel &, Diagnostics &) {}
}  // namespace tf::semantics
