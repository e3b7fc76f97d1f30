#include "tools/interruption.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <string>

namespace condyle {
namespace {

constexpr std::array interrupting = {SIGINT, SIGTERM};
std::string last_words;  // unchanged while a signal may arrive

extern "C" void print_and_end(int signal) {
  const auto written = ::write(STDERR_FILENO, last_words.data(), last_words.size());
  static_cast<void>(written);
  ::raise(signal);  // default action: the handler is reset
}

void set(void (*handler)(int), int flags) {
  for (const int signal : interrupting) {
    struct sigaction before = {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;  // as under nohup
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = flags;
    ::sigaction(signal, &action, nullptr);
  }
}

}  // namespace

Interruption::Interruption(const std::string& sentence) {
  last_words = "\n" + sentence + "\n";
  set(print_and_end, static_cast<int>(SA_RESETHAND | SA_NODEFER));
}

Interruption::~Interruption() { set(SIG_DFL, 0); }

}  // namespace condyle
