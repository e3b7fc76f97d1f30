#include "sim/plan/plan_file.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "engine/core/error.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/sim/plan/plans.h"

using namespace condyle;
using namespace condyle::test;

namespace {

const std::filesystem::path nowhere = "plan.json";

std::string parse_refusal(const std::string& text) {
  try {
    parse_plan(nowhere, text);
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("plan.json: ")) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "the plan was read:\n" << text;
  return "";
}

/// The sample's text with one passage replaced.
std::string edited(const std::string& from, const std::string& to) {
  std::string text = plan_json(sample_plan());
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

void expect_refused(const std::string& from, const std::string& to, const std::string& words) {
  const std::string message = parse_refusal(edited(from, to));
  EXPECT_NE(message.find(words), std::string::npos) << message;
}

double any_double(std::mt19937_64& random) {
  for (;;) {
    const double value = std::bit_cast<double>(random());
    if (std::abs(value) <= 100) return value;  // many are subnormal or of tiny exponents
  }
}

}  // namespace

TEST(PlanFile, TrimsAndZonesNeedVersion2) {
  EXPECT_EQ(version_of(sample_plan()), 1);
  const Plan trimmed = with_step(sample_plan(), TrimStep{"chin", {"mandible rest"}, true});
  EXPECT_EQ(version_of(trimmed), 2);
  const PlanZone line{.name = "artery", .radius_mm = 1.5, .points = {{0.1, 2, 3}, {4, 5, 1.0 / 3}}};
  const PlanZone surface{.name = "tumour",
                         .kind = ZoneKind::tooth,
                         .warn_mm = 8,
                         .stop_mm = 6,
                         .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                         .triangles = {{0, 1, 2}}};
  const Plan plan = with_zone(with_zone(trimmed, line), surface);
  EXPECT_EQ(parse_plan("plan.json", plan_json(plan)), plan);
  EXPECT_EQ(with_zone(plan, line), plan);  // replaces the one of its name
  EXPECT_EQ(without_zone(without_zone(plan, "artery"), "tumour"), trimmed);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = plan_json(plan);
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return parse_refusal(text);
  };
  EXPECT_NE(refused("[0, 1, 2]", "[0, 1, 3]").find("zones[1].triangles[0]"), std::string::npos);
  EXPECT_NE(refused("[0, 1, 2]", "[0, 1]").find("2 numbers"), std::string::npos);
  EXPECT_NE(refused("\"tooth\"", "\"nerve\"").find("tooth, canal, foramen or other"),
            std::string::npos);
  EXPECT_NE(refused("\"radius_mm\": 1.5", "\"radius_mm\": -1").find("radius_mm"),
            std::string::npos);
  EXPECT_NE(refused("\"of\": [\"mandible rest\"]", "\"of\": []").find("steps[5].trim.of"),
            std::string::npos);
  EXPECT_NE(refused("\"of\": [\"mandible rest\"]", "\"of\": [\"chin\"]").find("of[0]"),
            std::string::npos);
}

TEST(PlanFile, ReadsBackAsItWas) {
  const TempFolder folder;
  const Plan plan = sample_plan();
  save_plan(plan, folder.path() / "p.json");
  EXPECT_EQ(load_plan(folder.path() / "p.json"), plan);
  EXPECT_EQ(plan_json(load_plan(folder.path() / "p.json")), plan_json(plan));
}

TEST(PlanFile, NumbersKeepTheirBits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    Plan plan = sample_plan();
    auto& point = plan.geometry.landmarks.points["pns"];
    for (int k = 0; k < 3; ++k) point[k] = any_double(random);
    auto& move = std::get<ClinicalMove>(std::get<MoveStep>(plan.steps[1].action).move);
    move.left_mm = i == 0 ? -0.0 : any_double(random) / 2;
    move.yaw_deg = std::uniform_real_distribution<double>(-60, 60)(random);
    auto& pose = std::get<ExplicitMove>(std::get<MoveStep>(plan.steps[3].action).move).X_CS;
    pose.R = Eigen::Quaterniond(1, 0.5 * any_double(random) / 100, 0.1, 0).normalized();
    plan.geometry.parts[0].hash = random();
    const Plan back = parse_plan(nowhere, plan_json(plan));
    EXPECT_EQ(back, plan);
    EXPECT_EQ(back.geometry.parts[0].hash, plan.geometry.parts[0].hash);
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(bits(back.geometry.landmarks.points.at("pns")[k]), bits(point[k]));
    const auto& read = std::get<ClinicalMove>(std::get<MoveStep>(back.steps[1].action).move);
    EXPECT_EQ(bits(read.left_mm), bits(move.left_mm));
    EXPECT_EQ(bits(read.yaw_deg), bits(move.yaw_deg));
  }
}

TEST(PlanFile, IsReadable) {
  const std::string text = plan_json(sample_plan());
  EXPECT_NE(text.find("\n   \"basion\": [0.0, 0.0, -27.0],\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\"forward_mm\": 4.0"), std::string::npos);
  EXPECT_NE(text.find("\"note\": \"teeth 18, 28\\nout; bögen\""), std::string::npos);
}

TEST(PlanFile, WhatIsLeftOutHasItsDefault) {
  const std::string text =
      R"({"format": "condyle plan", "version": 1, "name": "short",
          "case": {"name": "c", "parts": [], "landmarks": {}},
          "reference": {"horizontal": "natural_head_position"},
          "steps": [{"id": 7, "move": {"segment": "mandible", "forward_mm": -5}}]})";
  const Plan plan = parse_plan(nowhere, text);
  EXPECT_EQ(plan.reference.horizontal, Horizontal::natural_head_position);
  EXPECT_EQ(plan.steps[0].id, 7);
  EXPECT_EQ(std::get<ClinicalMove>(std::get<MoveStep>(plan.steps[0].action).move),
            (ClinicalMove{.forward_mm = -5}));
}

TEST(PlanFile, SegmentsOfANamedOsteotomyHaveNamesOfTheirOwn) {
  const Plan plan = parse_plan(nowhere, edited("\"pieces\": [\"maxilla\"]", "\"pieces\": []"));
  EXPECT_TRUE(std::get<CutStep>(plan.steps[0].action).pieces.empty());
  CutStep unnamed;
  unnamed.target = "mandible";
  unnamed.surfaces = {PlanePatch{.reach = 10.0}};
  ASSERT_TRUE(problem_of(unnamed));
  EXPECT_EQ(problem_of(unnamed)->item, "pieces");
}

TEST(PlanFile, ACutBelowTheMarginsIsRememberedWhereItWasRequested) {
  EXPECT_EQ(plan_json(sample_plan()).find("below_margins"), std::string::npos);
  Plan plan = sample_plan();
  std::get<CutStep>(plan.steps[0].action).below_margins = true;
  EXPECT_NE(plan, sample_plan());
  EXPECT_NE(plan_json(plan).find("\"below_margins\": true"), std::string::npos);
  EXPECT_EQ(parse_plan(nowhere, plan_json(plan)), plan);
  EXPECT_EQ(
      parse_plan(nowhere, edited("\"kerf_mm\": 0.7", "\"kerf_mm\": 0.7, \"below_margins\": false")),
      sample_plan());
  expect_refused("\"kerf_mm\": 0.7", "\"kerf_mm\": 0.7, \"below_margins\": 1",
                 "steps[0].cut.below_margins: must be true or false");
}

TEST(PlanFile, AnyPartOfAFileIsRefused) {
  const std::string text = plan_json(sample_plan());
  for (std::size_t size = 0; size + 2 < text.size(); size += 13)
    EXPECT_NE(parse_refusal(text.substr(0, size)).find("JSON"), std::string::npos) << size;
}

TEST(PlanFile, NewerVersionsAndOtherFormatsAreRefused) {
  expect_refused("\"version\": 1", "\"version\": 3, \"colour\": 3", "version: is 3");
  expect_refused("\"version\": 1", "\"version\": 0", "version: is 0");
  expect_refused("\"version\": 1", "\"version\": 1.5", "version: is 1.5");
  expect_refused("condyle plan", "condyle case", "format: is \"condyle case\"");
  EXPECT_NE(parse_refusal("[]").find("is []"), std::string::npos);
  EXPECT_NE(parse_refusal("{}").find("\"format\" is missing"), std::string::npos);
}

TEST(PlanFile, NonsenseIsRefusedWithItemAndValue) {
  expect_refused("\"forward_mm\": 4.0", "\"forward_mm\": 200",
                 "steps[1].move: forward_mm is 200 mm; expected a number from -100 to 100");
  expect_refused("\"forward_mm\": 4.0", "\"forward_mm\": \"4\"",
                 "steps[1].move.forward_mm: is \"4\"; expected a number");
  expect_refused("\"forward_mm\": 4.0", "\"forward_mm\": 1e999", "not valid JSON");
  expect_refused("\"forward_mm\": 4.0", "\"advance_mm\": 4.0",
                 "steps[1].move: unknown key \"advance_mm\"");
  expect_refused("\"pitch_deg\": 0.0", "\"pitch_deg\": 80", "pitch_deg is 80");
  expect_refused("\"kerf_mm\": 0.7", "\"kerf_mm\": -1", "steps[0].cut.kerf_mm: is -1 mm");
  expect_refused("\"kerf_mm\": 0.7", "\"kerf\": 0.7", "steps[0].cut: unknown key \"kerf\"");
  expect_refused("\"radius_mm\": 12.5", "\"radius_mm\": 0",
                 "steps[2].cut.surfaces[1].radius_mm: is 0");
  expect_refused("\"normal\": [0.0, 0.0, 2.0]", "\"normal\": [0, 0]",
                 "steps[2].cut.surfaces[1].normal: has 2 numbers; expected 3");
  expect_refused("\"kind\": \"sheet\"", "\"kind\": \"curve\"", "surfaces[0].kind: is \"curve\"");
  expect_refused("\"depth_mm\": 40.0", "\"depth_mm\": null", "\"depth_mm\" is missing");
  expect_refused("\"height_mm\": 5.1", "\"height_mm\": [5]", "parameters.height_mm: is [5]");
  expect_refused("\"id\": 2", "\"id\": 1", "its number must be positive and unique");
  expect_refused("\"id\": 2", "\"id\": -2", "steps[1].id: is -2");
  expect_refused("\"segment\": \"chin\"", "\"segment\": 3", "steps[3].move.segment: is 3");
  expect_refused("\"rotation\": [0", "\"rotation\": [5, 0", "has 5 numbers");
  expect_refused("\"rotation\": [1.0, 0.0", "\"rotation\": [1.0, 0.5", "has the length");
  expect_refused("\"horizontal\": \"frankfort\"", "\"horizontal\": \"occlusal\"",
                 "reference.horizontal: is \"occlusal\"");
  expect_refused("\"shape\": \"", "\"shape\": \"x", "case.parts[0].shape");
  expect_refused("\"note\": ", "\"remark\": ", "steps[4]: unknown key \"remark\"");
  expect_refused("\"basion\": [0.0", "\"basion\": [1e7", "landmark basion is (1e+07, 0, -27)");
  expect_refused("\"up_mm\": 2.0", "\"up_mm\": 2.0, \"up_mm\": 3.0", "up_mm: appears twice");
  // Steps in an impossible order.
  const std::string maxilla = "\"pieces\": [\"maxilla\"]";
  expect_refused(maxilla, "\"pieces\": [\"chin\"]", "already made by step 1");
}

TEST(PlanFile, FailuresLeaveTheEarlierFile) {
  const TempFolder folder;
  const auto file = folder.path() / "p.json";
  const Plan plan = sample_plan();
  save_plan(plan, file);
  Plan broken = plan;
  std::get<ClinicalMove>(std::get<MoveStep>(broken.steps[1].action).move).up_mm =
      std::numeric_limits<double>::infinity();
  EXPECT_THROW(save_plan(broken, file), InputError);
  Plan garbled = plan;
  garbled.geometry.name = "\xff\xfe";  // no UTF-8
  EXPECT_THROW(save_plan(garbled, file), InputError);
  EXPECT_EQ(load_plan(file), plan);
  // What an interrupted program left beside it does no harm.
  folder.write(".p.json.1-0.part", "{");
  EXPECT_EQ(load_plan(file), plan);
  EXPECT_THROW(load_plan(folder.path() / "none.json"), InputError);
  EXPECT_THROW(load_plan(folder.path()), InputError);
}
