// What an operation that the user's data can make fail returns: a value, or a message for the user. No exception carries such errors,
// so that nothing has to be caught at the C interface.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace tf::runtime {

struct Failure {
  std::string text;
};

template <class T> class [[nodiscard]] Outcome {
public:
  Outcome(T value) : content_(std::move(value)) {}
  Outcome(Failure failure) : content_(std::move(failure)) {}

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  explicit operator bool() const { return ok(); }
  // Precondition: ok().
  [[nodiscard]] T &value() { return std::get<T>(content_); }
  [[nodiscard]] const T &value() const { return std::get<T>(content_); }
  // Precondition: not ok().
  [[nodiscard]] const std::string &error() const { return std::get<Failure>(content_).text; }

private:
  std::variant<T, Failure> content_;
};

template <> class [[nodiscard]] Outcome<void> {
public:
  Outcome() = default;
  Outcome(Failure failure) : failed_(true), text_(std::move(failure.text)) {}

  [[nodiscard]] bool ok() const { return !failed_; }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const std::string &error() const { return text_; }

private:
  bool failed_ = false;
  std::string text_;
};

}  // namespace tf::runtime
