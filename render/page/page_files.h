#pragma once

namespace condyle {

/// Text of viewer.css and viewer.js, which the build makes part of the program.
extern const char* const viewer_style;
extern const char* const viewer_script;

}  // namespace condyle
