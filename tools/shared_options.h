#pragma once

#include "tools/commands.h"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace condyle {

// Options that several subcommands have. Each adds them to a command and lets them write into the
// values.

/// A number from least to most; "nan" is none.
CLI::Validator within(double least, double most);

void add_muscles(CLI::App* command, MuscleMotionSettings& muscles);
void add_motion(CLI::App* command, MotionOptions& motion, bool motion_required);
void add_contact(CLI::App* command, MotionOptions& motion);
void add_respect_contact(CLI::App* command, MotionOptions& motion);
void add_tissue(CLI::App* command, MotionOptions& motion);
void add_recording(CLI::App* command, RecordOptions& record);
void add_pictures(CLI::App* command, PictureOptions& picture);

}  // namespace condyle
