#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/command.h"

namespace condyle {

struct DemoOptions {
  std::filesystem::path out;
  std::filesystem::path skull;      // mesh of a delivered skull, for the vault; empty: built-in
  std::filesystem::path landmarks;  // of that skull; empty: estimated
};

/// An operation that the program repeats on a built-in patient.
struct Demo {
  std::string name, what;
  int (*run)(const DemoOptions& options, const CommonOptions& common);
};

/// Class III: Le Fort I, sagittal split, the lower arch set by the bite; with the face afterwards.
int run_class_iii(const DemoOptions& options, const CommonOptions& common);
/// Jaw movement before and after that operation.
int run_jaw_before_after(const DemoOptions& options, const CommonOptions& common);
/// Craniosynostosis: the vault cut into panels and reshaped.
int run_vault(const DemoOptions& options, const CommonOptions& common);
/// Genioplasty, with the mouth opening afterwards.
int run_genioplasty(const DemoOptions& options, const CommonOptions& common);
/// A segment of the lower jaw resected, and rebuilt from a fibula; its insertion path; the mouth
/// opening.
int run_fibula(const DemoOptions& options, const CommonOptions& common);
/// A replayed list of mouse and keyboard steps in the window: from an empty plan of both jaws to a
/// saved one with splints. throws: MachineError without a display.
int run_by_hand(const DemoOptions& options, const CommonOptions& common);

}  // namespace condyle
