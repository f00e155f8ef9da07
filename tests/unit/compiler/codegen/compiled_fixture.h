// A system whose `dynamics` is a given function, compiled in memory or to a shared library that is loaded again.
#pragma once

#include "compiler/codegen/compiled_model.h"
#include "runtime/abi/tf_model.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <string>
#include <vector>

namespace tf::codegen::testing {

inline constexpr std::size_t dynamicsIndex = 4;

inline std::vector<ir::Function> asDynamics(ir::Function function) {
  std::vector<ir::Function> functions(modelFunctionCount);
  functions[dynamicsIndex] = std::move(function);
  return functions;
}

// A shared library's bytes, opened by the system's loader.
class Loaded {
public:
  explicit Loaded(const std::string &bytes) {
    std::string path = ::testing::TempDir() + "tf-model-XXXXXX";
    const int descriptor = mkstemp(path.data());
    std::ofstream(path, std::ios::binary) << bytes;
    library_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr)
      ADD_FAILURE() << dlerror();
    std::remove(path.c_str());
    std::fclose(fdopen(descriptor, "r"));
  }
  Loaded(const Loaded &) = delete;
  Loaded &operator=(const Loaded &) = delete;
  ~Loaded() { dlclose(library_); }

  [[nodiscard]] const tf_model *model() const { return static_cast<const tf_model *>(dlsym(library_, TF_MODEL_SYMBOL)); }

private:
  void *library_ = nullptr;
};

// Argument arrays of a call; outputs start as `untouched`.
inline constexpr double untouched = -12345.5;

struct Call {
  std::vector<std::vector<double>> inputs{TF_IN_COUNT, std::vector<double>(32, 0.0)};
  std::vector<std::vector<double>> outputs;

  explicit Call(const ir::Function &function) {
    for (const int size : function.bufferSizes)
      outputs.emplace_back(static_cast<std::size_t>(size), untouched);
  }

  void run(tf_function function, const std::vector<std::uint8_t> &mask = {}) {
    std::vector<const double *> in;
    std::vector<double *> out;
    for (const auto &array : inputs)
      in.push_back(array.data());
    for (auto &array : outputs)
      out.push_back(array.data());
    function(in.data(), out.data(), mask.empty() ? nullptr : mask.data());
  }
};

}  // namespace tf::codegen::testing
