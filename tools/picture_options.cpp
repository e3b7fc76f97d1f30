#include "tools/picture_options.h"

#include <CLI/CLI.hpp>

#include "tools/command.h"

namespace condyle {
namespace {

void add_cuts(CLI::App& command, PictureOptions& picture) {
  command
      .add_option("--clip", picture.clip,
                  "Remove what lies beyond a plane and close what it cuts: left, right, front, "
                  "back, above or below, optionally at so many mm from the middle between the "
                  "condyles (left:10); or X,Y,Z,NX,NY,NZ: a point and the outward normal")
      ->type_name("SIDE[:MM]");
  command
      .add_option("--clip-parts", picture.clip_parts,
                  "Parts that the plane cuts, as in --show; default all")
      ->type_name("PARTS");
  command.add_flag("--clip-open", picture.clip_open,
                   "Show the inner sides, drawn flat, instead of closing what is cut");
  command
      .add_option("--cut-away", picture.cut_away,
                  "Open a round window in the skin about a landmark or point, e.g. "
                  "left_condyle,35")
      ->type_name("PLACE,RADIUS");
}

void add_overlays(CLI::App& command, PictureOptions& picture) {
  command
      .add_option("--overlay", picture.overlay,
                  "Also draw, separated by commas: springs, prisms, bone-springs, layers (of the "
                  "tissue), muscles (of the jaw), muscle-labels (the same with names), "
                  "facial-muscles, axes, paths (of condyles and incisal point), ghost (the rest "
                  "position), wireframe[:PARTS], patches (of contact), "
                  "scale, letters (L R A P S I)")
      ->type_name("LIST");
  in_range(
      command.add_option("--wipe", picture.wipe,
                         "At the left of this fraction of the width rest, with --plan before the "
                         "operation; at the right now"),
      0, 1);
  command.add_flag("--before-after", picture.before_after,
                   "Three pictures of that size side by side: at rest, now, and now with the skin "
                   "coloured by its displacement");
  command
      .add_option("--caption", picture.caption,
                  "Words at the foot of the picture; {time}, {opening} (drop of the lower incisal "
                  "point), {interincisal} (between the incisal edges), {rotation}, {frame} and "
                  "{motion} are filled in, | breaks the line")
      ->type_name("TEXT");
}

void add_quality(CLI::App& command, PictureOptions& picture) {
  command.add_flag("--light", picture.light, "A light background in place of the dark one");
  command.add_flag("--transparent", picture.transparent, "No background: PNG with alpha");
  static const Choices<int> edges = {{"msaa4", 0}, {"fxaa", 0}, {"none", 0}};
  command
      .add_option_function<std::string>(
          "--edges",
          [&picture](const std::string& word) {
            chosen(edges, "--edges", word);
            picture.edges = word;
          },
          "How edges are smoothed: by four samples per pixel (the default; fewer are reported), by "
          "a filter (twice as fast), or not at all")
      ->type_name(words_of(edges));
  in_range(command.add_option("--supersample", picture.supersample,
                              "Draw so many times as wide and high, then average; default 1"),
           1, 4);
  command.add_flag_callback(
      "--no-shadows", [&picture] { picture.shadows = false; }, "Draw no shadows");
  command.add_flag_callback(
      "--no-folds", [&picture] { picture.folds = false; },
      "Draw the face without what is in pictures alone: folds of compressed skin, and the hollows "
      "of "
      "the cheeks and the pad under the chin of an open mouth");
  command.add_flag("--life", picture.life,
                   "Look only: an opaque face blinks, looks around and breathes, and the head "
                   "extends as the jaw opens; nothing measured changes");
}

}  // namespace

void add_pictures(CLI::App& command, PictureOptions& picture) {
  begin_group(command, "Camera");
  command
      .add_option("--size", picture.size,
                  "Size of a picture, up to 8192 a side; default 1280x720 (4K: 3840x2160)")
      ->type_name("WIDTHxHEIGHT");
  command
      .add_option("--camera", picture.camera,
                  "front, back, left, right, three-quarter (the default), above, below, spin, "
                  "upper-arch, lower-arch, or a JSON file with a view or a path of views; several "
                  "separated by commas")
      ->type_name("VIEW|FILE");
  begin_group(command, "Look");
  command
      .add_option("--show", picture.show,
                  "What to draw: all (the default), bones, teeth, segments, transplants, skin, "
                  "mouth, contacts or names of parts, each with an optional opacity, e.g. "
                  "bones,teeth,skin:0.4; distance colours bones and teeth by their distance from "
                  "what they may meet, displacement the skin by its displacement from rest")
      ->type_name("PARTS");
  in_range(command.add_option("--distance-near", picture.distance_near_mm,
                              "Distances up to here are coloured, mm; default 2"),
           0.5, 10);
  add_cuts(command, picture);
  add_overlays(command, picture);
  add_quality(command, picture);
}

}  // namespace condyle
