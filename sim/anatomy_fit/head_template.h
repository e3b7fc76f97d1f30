#pragma once

#include "engine/registration/fit_surface.h"
#include "sim/case/case.h"

namespace condyle {

/// Coarse surfaces of the built-in patient for registration.
struct HeadTemplate {
  HeadTemplate(const Case& model, int threads);

  FitSurface skull;     // with the upper teeth
  FitSurface mandible;  // with the lower teeth
  FitSurface whole;     // both
};

/// Coarse skin of the built-in patient.
FitSurface template_skin(const Case& model, int threads);

/// A scanned surface, welded and coarsened. throws: InputError naming `source` when it has no
/// triangles or faces inward.
FitSurface scanned_surface(TriMesh surface, int samples, int threads, const std::string& source);

/// Adds the triangles of another surface.
void append_surface(TriMesh& mesh, const TriMesh& other);

}  // namespace condyle
