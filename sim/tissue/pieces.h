#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/tissue/tissue.h"
#include "sim/tissue/tissue_contact.h"

namespace condyle {

/// A bone that has been cut into pieces, each a separate body.
struct CutBone {
  BodyId whole;                     // body of the uncut bone; a piece may keep its number
  TriMesh surface;                  // of the uncut bone with its teeth, mm, at rest
  std::vector<BodyId> owner;        // of each triangle of `surface`: the piece it belongs to
  std::vector<BodySurface> pieces;  // with their cut faces, at their poses in the uncut bone
  std::vector<char> resected = {};  // of each triangle: its bone was removed; empty where none was
  std::vector<BodySurface> grafts = {};  // bone that tissue may touch, where it lay in none before
  /// Fraction of the nose that the septum holds to the piece with the body of the whole bone.
  double septum = 0;
};

/// The tissue of an uncut patient on the pieces of its bones: the same mesh, springs, rest state
/// and displayed face, held by other bodies, so that the face of a plan is the same model at other
/// poses. Tissue moves with the piece that owns the nearest triangle of its bone; grafts push it
/// aside; tissue carried by
/// several bodies, and the cartilage of the nose, has harmonic weights over the mesh. `jaw`: the
/// bodies of the arches after the cuts. throws: InputError for a cut whose owners do not match its
/// surface, or name no piece.
std::shared_ptr<const TissueModel> carry_to_pieces(const TissueModel& uncut,
                                                   std::span<const CutBone> cuts,
                                                   const JawBodies& jaw = {}, int threads = 1);

}  // namespace condyle
