#include "runtime/results/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace tf::runtime {

namespace {

Failure systemFailure(const std::string &path, const char *what) {
  return {"cannot " + std::string(what) + " '" + path + "': " + std::generic_category().message(errno)};
}

}  // namespace

Outcome<OutputFile> OutputFile::create(const std::string &path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0)
    return systemFailure(path, "write");
  return OutputFile(descriptor, path);
}

OutputFile::OutputFile(OutputFile &&other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)), state_(std::move(other.state_)) {}

OutputFile &OutputFile::operator=(OutputFile &&other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  std::swap(state_, other.state_);
  return *this;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

Outcome<void> OutputFile::write(std::string_view bytes) {
  while (state_ && !bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      state_ = systemFailure(path_, "write to");
  }
  return state_;
}

Outcome<void> OutputFile::close() {
  if (descriptor_ >= 0 && ::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR && state_)
    state_ = systemFailure(path_, "write to");
  return state_;
}

}  // namespace tf::runtime
