#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace condyle {

// Additions to the surfaces in a picture, and parts that are removed from them. Positions are in
// the cranium's frame, mm; colours sRGB, 0 to 1; parts are named as in the case.

/// Removes the side that the normal points to. The removed side casts no shadow.
struct ClippingPlane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // any length but 0
  /// Cut faces are closed in the tissue's own colour. Otherwise, and where a surface is too damaged
  /// to have an inside, its inner side is drawn flat in that colour, so that nothing looks hollow.
  bool capped = true;
  std::vector<std::string> parts = {};  // parts that are cut; empty = all
};

/// Removes the inside of a ball: a window in the skin over the joint.
struct CutAway {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_mm = 30;
  std::vector<std::string> parts = {};  // parts that are cut; empty = the face
};

/// Translucent copies of parts at rest.
struct Ghost {
  std::vector<std::string> parts = {};  // empty = those that have moved and are drawn
  double opacity = 0.35;
  Eigen::Vector3f color = {0.34f, 0.71f, 0.91f};  // Okabe-Ito sky blue
};

/// Lines and dots in space, of constant width on the screen.
struct LineSet {
  std::vector<Eigen::Vector3f> ends = {};    // two for each line
  std::vector<Eigen::Vector3f> colors = {};  // one for each line; empty = `color`
  std::vector<Eigen::Vector3f> dots = {};
  Eigen::Vector3f color = {0.9f, 0.9f, 0.9f};
  float width_px = 2;   // of a picture 1080 high
  float dot_mm = 0.8f;  // radius
  float through = 0.3;  // opacity where something lies in front of them; 0 = hidden
  float opacity = 1;    // overall

  bool empty() const { return ends.empty() && dots.empty(); }
};

/// A translucent surface in space of one colour, e.g. a layer of tissue: only its nearest side.
struct GlassSheet {
  std::vector<Eigen::Vector3f> positions = {};
  std::vector<Eigen::Vector3i> triangles = {};
  Eigen::Vector3f color = {0.9f, 0.9f, 0.9f};
  float opacity = 0.4f;

  bool empty() const { return triangles.empty() || !(opacity > 0); }
};

/// An opaque body of fibres in space, e.g. the belly of a muscle: lit, with stripes along it, and
/// hidden by what lies in front of it.
struct FibreBody {
  std::vector<Eigen::Vector3f> positions = {};
  std::vector<Eigen::Vector3i> triangles = {};  // closed, counter-clockwise from outside
  std::vector<Eigen::Vector3f> colors = {};     // one for each position
  std::vector<float> fibres = {};  // one for each position: constant along a fibre, one each unit
  float opacity = 1;

  bool empty() const { return triangles.empty() || !(opacity > 0); }
};

/// Words at a point in space.
struct PlaceLabel {
  std::string words = {};
  Eigen::Vector3f place = Eigen::Vector3f::Zero();
};

/// A chain of points as lines, added to the set.
void add_run(LineSet& lines, const std::vector<Eigen::Vector3f>& points);
/// A line with a head of a tenth of its length.
void add_arrow(LineSet& lines, const Eigen::Vector3f& from, const Eigen::Vector3f& to);

}  // namespace condyle
