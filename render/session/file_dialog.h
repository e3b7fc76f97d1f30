#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/window/view/ui_commands.h"

namespace condyle {

/// The file dialog of the desktop, shown by a child process (zenity, qarma or kdialog), which is
/// only polled: it never blocks the front end.
class FileDialog {
 public:
  /// How a dialog ended.
  struct Answer {
    request::Browse asked;
    std::vector<std::filesystem::path> files = {};  // none: cancelled
    std::string trouble = {};                       // a sentence; empty if the dialog worked
  };

  FileDialog() = default;
  ~FileDialog();  // closes the dialog
  FileDialog(const FileDialog&) = delete;
  FileDialog& operator=(const FileDialog&) = delete;

  /// Path of the program that shows dialogs, as found in $PATH; empty: the desktop has none.
  static std::filesystem::path program();

  /// Shows a dialog; one at a time. throws: MachineError if the program cannot be started.
  void show(const request::Browse& asked);
  bool open() const { return child_ > 0; }
  /// Once a turn: the answer, when there is one.
  std::optional<Answer> take();

 private:
  void read_more();

  request::Browse asked_;
  pid_t child_ = -1;
  int pipe_ = -1;
  std::string words_;  // that the program has printed so far
};

/// Arguments of a dialog program. Only for its own module and tests.
std::vector<std::string> dialog_arguments(const std::filesystem::path& program,
                                          const request::Browse& asked);

}  // namespace condyle
