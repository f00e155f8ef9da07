#include "tests/support/process.h"

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <poll.h>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace tf::test {

namespace fs = std::filesystem;

namespace {

constexpr auto kLongestRun = std::chrono::seconds(60);

struct Pipe {
  std::array<int, 2> ends = {-1, -1};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("no pipe");
  }
};

[[noreturn]] void becomeProgram(const fs::path &program, const std::vector<std::string> &arguments, const fs::path &folder,
                                const std::vector<std::string> &environment, const Pipe &out, const Pipe &err) {
  dup2(out.ends[1], STDOUT_FILENO);
  dup2(err.ends[1], STDERR_FILENO);
  if (chdir(folder.c_str()) != 0)
    _exit(127);
  for (const std::string &entry : environment) {
    const std::size_t equals = entry.find('=');
    setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
  }
  std::vector<char *> argv = {const_cast<char *>(program.c_str())};
  for (const std::string &argument : arguments)
    argv.push_back(const_cast<char *>(argument.c_str()));
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  _exit(127);
}

// Reads both pipes to their ends; false if that takes longer than a hanging program is waited for.
bool drain(int out, int err, ProcessResult &result) {
  const auto limit = std::chrono::steady_clock::now() + kLongestRun;
  std::array<pollfd, 2> polls = {{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  std::array<char, 4096> buffer;
  while (polls[0].fd >= 0 || polls[1].fd >= 0) {
    if (std::chrono::steady_clock::now() > limit)
      return false;
    if (poll(polls.data(), polls.size(), 1000) <= 0)
      continue;
    for (pollfd &entry : polls) {
      if (entry.fd < 0 || entry.revents == 0)
        continue;
      const ssize_t count = read(entry.fd, buffer.data(), buffer.size());
      if (count > 0)
        (entry.fd == out ? result.out : result.err).append(buffer.data(), static_cast<std::size_t>(count));
      else
        entry.fd = -1;
    }
  }
  return true;
}

}  // namespace

ProcessResult runProcess(const fs::path &program, const std::vector<std::string> &arguments, const fs::path &folder,
                         const std::vector<std::string> &environment) {
  const Pipe out, err;
  const pid_t child = fork();
  if (child < 0)
    throw std::runtime_error("no process");
  if (child == 0)
    becomeProgram(program, arguments, folder, environment, out, err);
  close(out.ends[1]);
  close(err.ends[1]);
  ProcessResult result;
  if (!drain(out.ends[0], err.ends[0], result)) {
    kill(child, SIGKILL);
    result.err += "\n(killed: it did not end)\n";
  }
  close(out.ends[0]);
  close(err.ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

ProcessResult runTfc(const std::vector<std::string> &arguments, const fs::path &folder) {
  return runProcess(TF_BINARY_DIR "/tfc", arguments, folder, {"TFC_CACHE_DIR=" TF_BINARY_DIR "/test-cache"});
}

double finalValue(const ProcessResult &result, const std::string &name) {
  const std::string text = "\n" + result.out, line = "\n" + name + " = ";
  const std::size_t place = text.find(line);
  return place == std::string::npos ? std::nan("") : std::stod(text.substr(place + line.size()));
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "tfc-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

std::string readFile(const fs::path &path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

void writeFile(const fs::path &path, const std::string &text) {
  std::ofstream file(path, std::ios::binary);
  if (!(file << text))
    throw std::runtime_error("cannot write " + path.string());
}

}  // namespace tf::test
