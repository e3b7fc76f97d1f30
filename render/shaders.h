#pragma once

#include <compare>
#include <string>

namespace condyle {

/// GLSL 3.30 sources. What they need as uniforms is set in lights.cpp, material.cpp and passes.cpp.
struct ShaderSource {
  std::string vertex, fragment;
};

/// What of its work a shader does. Fixed when it is built: without a card both sides of a branch
/// are run for every pixel.
struct Shading {
  bool shadowed = false, mapped = false, coated = false, cuttable = false, seen_through = false;
  bool skin = false;      // else bone, teeth, eyes, ...: of what is kept of a pixel
  bool deferred = false;  // lights pixels that were kept (see surface_buffer.h)
  auto operator<=>(const Shading&) const = default;
};

ShaderSource surface_shaders(const Shading&);   // bone, teeth, eyes, gums, tongue
ShaderSource skin_shaders(const Shading&);      // outside of the face
ShaderSource interior_shaders(const Shading&);  // its inside, seen through the mouth or from behind
ShaderSource keep_shaders(const Shading&);      // what light depends on, pixel by pixel
ShaderSource carry_shaders();                   // takes over the lit pixels, surface by surface
ShaderSource place_shaders();                   // or all at once
ShaderSource depth_shaders();  // only depth: shadow map and prepass of translucent parts
ShaderSource background_shaders();
ShaderSource marker_shaders();  // contact points and dots
ShaderSource line_shaders();
ShaderSource cap_shaders();   // the plane that closes a cut solid
ShaderSource tint_shaders();  // ghosts and wireframes

}  // namespace condyle
