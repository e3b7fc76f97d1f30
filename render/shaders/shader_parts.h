#pragma once

#include <string>

namespace condyle {

struct Shading;

// GLSL building blocks of the surface shaders.

/// A vertex shader that outputs the inputs of lighting.
std::string surface_vertices();
/// The first lines of a fragment shader.
std::string shading_constants(const Shading& shading);

extern const char* const shade_offset_source;   // where the shadow map is sampled for a point
extern const char* const backdrop_source;       // the colour behind everything
extern const char* const whole_picture_source;  // a vertex shader
extern const char* const pixel_source;          // declares the inputs of lighting
extern const char* const begin_pixel_source;    // and reads them

}  // namespace condyle
