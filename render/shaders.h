#pragma once

#include <string>

namespace condyle {

/// GLSL 3.30 sources. What they need as uniforms is set in lights.cpp, material.cpp and passes.cpp.
struct ShaderSource {
  std::string vertex, fragment;
};

ShaderSource surface_shaders();   // bone, teeth, eyes, gums, tongue
ShaderSource skin_shaders();      // outside of the face
ShaderSource interior_shaders();  // inside of the face, seen through the mouth or from behind
ShaderSource depth_shaders();     // only depth: shadow map and prepass of translucent parts
ShaderSource background_shaders();
ShaderSource marker_shaders();  // contact points and dots
ShaderSource line_shaders();
ShaderSource cap_shaders();   // the plane that closes a cut solid
ShaderSource tint_shaders();  // ghosts and wireframes

}  // namespace condyle
