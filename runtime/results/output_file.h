// A file that is written in whole pieces, with errors (no permission, full disk) as messages that name it.
#pragma once

#include "runtime/model/outcome.h"

#include <string>
#include <string_view>

namespace tf::runtime {

class OutputFile {
public:
  // Creates or truncates the file.
  static Outcome<OutputFile> create(const std::string &path);
  OutputFile(OutputFile &&other) noexcept;
  OutputFile &operator=(OutputFile &&other) noexcept;
  OutputFile(const OutputFile &) = delete;
  OutputFile &operator=(const OutputFile &) = delete;
  ~OutputFile();

  // On return all bytes are with the operating system. After an error nothing more is written and the same error is returned.
  Outcome<void> write(std::string_view bytes);
  // Reports what the file system had put off; further calls do nothing.
  Outcome<void> close();
  [[nodiscard]] const std::string &path() const { return path_; }

private:
  OutputFile(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}

  int descriptor_;  // -1: closed
  std::string path_;
  Outcome<void> state_;
};

}  // namespace tf::runtime
