#include "tests/support/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/support/places.h"
#include "tests/support/sanitizers.h"

namespace condyle::test {
namespace fs = std::filesystem;

namespace {
#ifdef CONDYLE_ADDRESS_SANITIZER
constexpr bool reserves_address_space = true;  // AddressSanitizer takes terabytes at the start
#else
constexpr bool reserves_address_space = false;
#endif
}  // namespace

Folder::Folder() {
  std::string name = (fs::temp_directory_path() / "condyle-test-XXXXXX").string();
  if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string read_text(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Outcome condyle(const std::vector<std::string>& arguments, const Limits& limits) {
  const Folder streams;
  const std::string out = streams / "out", err = streams / "err";
  const std::string program = program_file();
  const pid_t child = ::fork();
  if (child == 0) {
    const int o = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600);
    const int e = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    const int i = ::open("/dev/null", O_RDONLY);
    ::dup2(i, 0);
    ::dup2(o, 1);
    ::dup2(e, 2);
    if (limits.memory_mb > 0 && !reserves_address_space) {
      const rlimit limit{static_cast<rlim_t>(limits.memory_mb) << 20,
                         static_cast<rlim_t>(limits.memory_mb) << 20};
      ::setrlimit(RLIMIT_AS, &limit);
    }
    if (limits.file_mb >= 0) {
      ::signal(SIGXFSZ, SIG_IGN);  // writes then fail with EFBIG, as on a full disk
      const rlimit limit{static_cast<rlim_t>(limits.file_mb) << 20,
                         static_cast<rlim_t>(limits.file_mb) << 20};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::setenv("XDG_CONFIG_HOME", streams.path().c_str(), 1);  // no user's settings
    std::vector<char*> argv = {const_cast<char*>(program.c_str())};
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    ::execv(program.c_str(), argv.data());
    ::_exit(127);
  }
  int status = 0;
  bool ended = false;
  while (limits.kill_when && !ended) {
    if (limits.kill_when()) {
      ::kill(child, limits.kill_signal);
      break;
    }
    ended = ::waitpid(child, &status, WNOHANG) == child;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!ended) ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(out),
          read_text(err)};
}

namespace {

std::string stl_box(const char* name, std::array<double, 3> low, std::array<double, 3> high) {
  const auto corner = [&](int i) {
    std::ostringstream text;
    text << "vertex " << ((i & 1) ? high[0] : low[0]) << ' ' << ((i & 2) ? high[1] : low[1]) << ' '
         << ((i & 4) ? high[2] : low[2]) << '\n';
    return text.str();
  };
  const int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::string text = std::string("solid ") + name + "\n";
  for (const auto& face : faces)
    text += "facet normal 0 0 0\nouter loop\n" + corner(face[0]) + corner(face[1]) +
            corner(face[2]) + "endloop\nendfacet\n";
  return text + std::string("endsolid ") + name + "\n";
}

}  // namespace

void write_box_patient(const fs::path& folder) {
  write_text(folder / "maxilla.stl", stl_box("maxilla", {-30, -90, -40}, {30, -40, 0}));
  write_text(folder / "mandible.stl", stl_box("mandible", {-50, -92, -80}, {50, 0, -41}));
  write_text(folder / "marks.csv",
             "name,x_mm,y_mm,z_mm\nlowerincisor,0,-92,-41\nupperincisor,0,-90,-40\n"
             "ltmj,48,-5,-12\nrtmj,-48,-5,-12\n");
}

std::string box_case(const Folder& folder) {
  write_box_patient(folder.path());
  const std::string made = folder / "boxes";
  const auto outcome =
      condyle({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
               folder / "mandible.stl", "--landmarks", folder / "marks.csv", "--out", made});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return made;
}

}  // namespace condyle::test
