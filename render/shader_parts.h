#pragma once

#include <string>

namespace condyle {

struct Shading;

// What the shaders of surfaces are put together from; GLSL.

/// A vertex shader that gives what light depends on.
std::string surface_vertices();
/// The first lines of a fragment shader.
std::string shading_constants(const Shading& shading);

extern const char* const shade_offset_source;   // where a place's shadow is looked up
extern const char* const whole_picture_source;  // a vertex shader
extern const char* const pixel_source;          // declares what light depends on
extern const char* const begin_pixel_source;    // and reads it

}  // namespace condyle
