// A compiled model from a file: opening the shared library and checking that what it exports is a model of this version.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/model/outcome.h"

#include <memory>
#include <string>

namespace tf::runtime {

// Whether the table keeps the contract of runtime/abi/tf_model.h as far as it can be seen without calling anything: version, counts,
// pointers, indices of variables, aliases, contacts and friction elements, tangential rows in order and without gaps.
Outcome<void> checkModel(const tf_model &model);

// Owns the library; the model lives as long as this.
class LoadedModel {
public:
  // The file must be a 64-bit ELF shared library for this machine (looked at before the system's loader is asked, whose messages are poor
  // and which runs code of the library) that exports TF_MODEL_SYMBOL. A path without a slash is a file in the working directory.
  static Outcome<LoadedModel> open(const std::string &path);

  [[nodiscard]] const tf_model &model() const { return *model_; }

private:
  struct CloseLibrary {
    void operator()(void *library) const;
  };
  using Library = std::unique_ptr<void, CloseLibrary>;

  LoadedModel(Library library, const tf_model *model) : library_(std::move(library)), model_(model) {}

  Library library_;
  const tf_model *model_;
};

}  // namespace tf::runtime
