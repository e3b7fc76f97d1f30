#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <thread>

#include "engine/collide/plain_query.h"
#include "engine/collide/slide.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/refine.h"
#include "engine/mesh/simplify.h"
#include "engine/rigid/rigid_world.h"
#include "sim/contact/contact.h"
#include "sim/dynamics/muscle_jaw.h"
#include "sim/report/report.h"
#include "tools/bench/baseline/bullet_mesh_pair.h"
#include "tools/bench/baseline/rigid_scenes.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// Milliseconds that the work takes.
struct Took {
  double wall_ms = 0, cpu_ms = 0;
};
template <class Work>
Took timed(Work&& work) {
  const Stopwatch watch;
  work();
  return {watch.wall_ms(), watch.cpu_ms()};
}

struct Results {
  Json rows = Json::array();

  void add(const std::string& name, const std::vector<double>& ms, const Json& parameters) {
    const auto times = summarise(ms);
    Json row = {{"name", name},
                {"median", times.median},
                {"p95", times.p95},
                {"unit", "ms"},
                {"samples", ms.size()}};
    row.update(parameters);
    rows.push_back(row);
  }
  void add(const std::string& name, const std::vector<Took>& all, const Json& parameters) {
    std::vector<double> wall, cpu;
    for (const Took& took : all) {
      wall.push_back(took.wall_ms);
      cpu.push_back(took.cpu_ms);
    }
    const auto times = summarise(cpu);
    add(name, wall, parameters);
    rows.back()["cpu_median"] = times.median;
    rows.back()["cpu_p95"] = times.p95;
  }
};

TriMesh joined(TriMesh a, const TriMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back(t + Eigen::Vector3i::Constant(first));
  return a;
}

/// The same surface in about that many triangles: simplified, or divided near `center`.
TriMesh sized(const TriMesh& mesh, int triangles, const Vector3d& center) {
  TriMesh result = simplify(mesh, triangles);
  for (double edge = 1;
       static_cast<double>(result.triangles.size()) < 0.98 * triangles && edge > 0.02; edge *= 0.9)
    result = refine_near(std::move(result), center, 60, edge, 2 * triangles);
  return result;
}

/// Skull with upper teeth and mandible with lower teeth, each as one surface.
struct Jaws {
  TriMesh upper, lower;
  Box bite;  // around both arches
  Vector3d center;
  std::array<Vector3d, 2> condyles;
};

const Part& part_of(const Case& patient, Role role) {
  const Part* part = patient.find(role);
  if (!part)
    throw InputError(
        "bench collide needs a case with a mandible, both arches of teeth, and a "
        "skull or a maxilla; without CASE it takes the built-in patient");
  return *part;
}

Jaws find_jaws(const Case& patient) {
  const Role bone = patient.find(Role::skull) ? Role::skull : Role::maxilla;
  const TriMesh &upper = part_of(patient, Role::upper_teeth).mesh,
                &lower = part_of(patient, Role::lower_teeth).mesh;
  Jaws jaws{joined(part_of(patient, bone).mesh, upper),
            joined(part_of(patient, Role::mandible).mesh, lower),
            bounding_box(upper),
            {},
            {}};
  jaws.bite.add(bounding_box(lower));
  jaws.center = jaws.bite.center();
  const auto& points = patient.landmarks.points;
  for (const auto& [side, name] : {std::pair(0, "left_condyle"), std::pair(1, "right_condyle")})
    if (const auto found = points.find(name); found != points.end())
      jaws.condyles[static_cast<std::size_t>(side)] = found->second;
  return jaws;
}

/// One thread, and the maximum.
std::vector<int> thread_counts(int threads) {
  return threads > 1 ? std::vector<int>{1, threads} : std::vector<int>{1};
}

/// Around the crowns, with a margin for the displacements of the benchmark.
ContactSurfaceSettings near_bite(const Jaws& jaws) {
  ContactSurfaceSettings settings;
  settings.field.region =
      Box{jaws.bite.low - Vector3d::Constant(6), jaws.bite.high + Vector3d::Constant(6)};
  return settings;
}

/// Target pose of the mandible for grinding teeth: pressed up to 1.5 mm into each other.
Pose grinding(const Jaws& jaws, int frame) {
  const double s = 0.06 * frame;
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.01 * std::sin(1.7 * s), Vector3d(0.3, 0.8, 0.5).normalized()));
  const Vector3d shift(1.8 * std::sin(s), 1.2 * std::sin(0.7 * s), 0.9 + 0.6 * std::sin(1.3 * s));
  return {turn, jaws.center + shift - turn * jaws.center};
}

/// Two bones that grind on each other: time for the nearest touching poses, and of FCL and Bullet
/// for the contacts alone.
void measure_pair(const Jaws& jaws, int triangles, int threads, bool baselines, Results& results) {
  const TriMesh upper = sized(jaws.upper, triangles, jaws.center),
                lower = sized(jaws.lower, triangles, jaws.center);
  const auto fixed = std::make_shared<const ContactSurface>(
                 make_contact_surface(upper, near_bite(jaws), threads)),
             moving = std::make_shared<const ContactSurface>(
                 make_contact_surface(lower, near_bite(jaws), threads));
  SlideSettings settings;
  settings.pivot = jaws.center;
  const SlidingContact model({fixed}, {moving}, settings);
  const PlainSurface surface_a(upper), surface_b(lower);
  const int most = static_cast<int>(std::max(upper.triangles.size(), lower.triangles.size()));

  constexpr int frames = 300, warm_up = 10, look_every = 6;
  for (const int count : thread_counts(threads)) {
    std::vector<Took> ms, fcl;
    std::vector<double> depths;
    int touching = 0, fewest = 1 << 30;
    SlideCache memory;
    Pose X = grinding(jaws, 0);
    X.t.z() -= 3;
    for (int frame = 0; frame < frames + warm_up; ++frame) {
      const Pose target = grinding(jaws, frame);
      SlideResult result;
      const Took took = timed([&] { result = model.slide(X, target, &memory, count); });
      X = result.X_FM;
      if (frame < warm_up) continue;
      ms.push_back(took);
      touching += result.touching;
      depths.push_back(result.depth_mm);
      if (count > 1 || frame % look_every != 0) continue;
      PlainQuery found;
      fcl.push_back(timed([&] { found = plain_query(surface_a, {}, surface_b, target, 256); }));
      fewest = std::min(fewest, found.contacts);
      // At contact they do not cross: then it computes their distance.
      fcl.push_back(timed([&] { plain_query(surface_a, {}, surface_b, X, 256); }));
    }
    results.add("collide.pair", ms,
                {{"triangles", most},
                 {"threads", count},
                 {"touching_frames", touching},
                 {"worst_depth_mm", *std::max_element(depths.begin(), depths.end())}});
    if (!fcl.empty())
      results.add("collide.baseline", fcl,
                  {{"method", "FCL, cold: contacts, or else distance; no response"},
                   {"triangles", most},
                   {"threads", 1},
                   {"fewest_contacts_at_wanted_pose", fewest}});
  }
  if (!baselines) return;
  BulletMeshPair bullet(upper, lower);
  std::vector<Took> ms;
  int contacts = 0;
  for (int frame = warm_up; frame < frames; frame += 50) {
    BulletMeshPair::Found found;
    ms.push_back(timed([&] { found = bullet.find(grinding(jaws, frame)); }));
    contacts = std::max(contacts, found.contacts);
  }
  results.add("collide.baseline", ms,
              {{"method", "Bullet GImpact, contacts; no response"},
               {"triangles", most},
               {"threads", 1},
               {"most_contacts", contacts}});
}

/// A block of bone with bumps on its ends.
TriMesh bumpy_block(int triangles) {
  const Vector3d half(7, 5, 5);
  TriMesh block;
  for (int i = 0; i < 8; ++i)
    block.vertices.emplace_back((i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(),
                                (i & 4 ? 1 : -1) * half.z());
  block.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  block = sized(block, triangles, Vector3d::Zero());
  for (auto& v : block.vertices)
    v.x() *= 1 + 0.03 * std::sin(1.1 * v.y() + 0.4) * std::sin(0.9 * v.z());
  return block;
}

/// Ten blocks in a row, compressed and shaken: each pushes its neighbours.
void measure_segments(int threads, Results& results) {
  constexpr int count = 10, warm_up = 300, steps = 600;
  constexpr double bone_kg_mm3 = 1.9e-6, squeeze_N = 0.5, shake_N = 5e-3;
  const TriMesh mesh = bumpy_block(10000);
  const auto surface =
      std::make_shared<const ContactSurface>(make_contact_surface(mesh, {}, threads));
  RigidSettings settings;
  settings.gravity_mm_s2.setZero();
  RigidWorld world(settings);
  DynamicBody block;
  block.mass = mass_properties(mesh, bone_kg_mm3);
  block.surfaces = {surface};
  block.drag_N_s_mm = 2e-3;
  block.turning_drag_N_mm_s = 1e-2;
  std::vector<int> forces;
  for (int i = 0; i < count; ++i) {
    block.X_WB.t = {14.3 * i, 0, 0};
    const int body = world.add_body(block);
    forces.push_back(world.add_force({.body = body}));
    if (i > 0) world.add_pair({.a = body - 1, .b = body});
  }
  std::vector<Took> ms;
  std::size_t fewest = 1 << 20;
  int apart = 0;
  for (int step = 0; step < warm_up + steps; ++step) {
    for (int i = 0; i < count; ++i) {
      const double along = i == 0 ? squeeze_N : i == count - 1 ? -squeeze_N : 0;
      world.set_force(forces[static_cast<std::size_t>(i)],
                      {along, shake_N * std::sin(0.05 * step + 2.1 * i),
                       shake_N * std::cos(0.04 * step + 1.3 * i)});
    }
    const Took took = timed([&] { world.step(threads); });
    if (step < warm_up) continue;
    ms.push_back(took);
    fewest = std::min(fewest, world.contacts().size());
    std::vector<bool> pushes(count, false);
    for (const auto& contact : world.contacts())
      pushes[static_cast<std::size_t>(contact.pair)] = true;
    apart += static_cast<int>(std::count(pushes.begin(), pushes.end() - 1, false));
  }
  results.add("collide.segments", ms,
              {{"segments", count},
               {"triangles", mesh.triangles.size()},
               {"threads", threads},
               {"fewest_contacts", fewest},
               {"pair_steps_apart", apart}});
}

/// The mandible closes under a force and grinds: timed per simulated second.
void measure_dynamics(const Jaws& jaws, int threads, Results& results) {
  constexpr int seconds = 3, triangles = 50000;
  constexpr double bone_kg_mm3 = 1.9e-6;
  const TriMesh upper = sized(jaws.upper, triangles, jaws.center),
                lower = sized(jaws.lower, triangles, jaws.center);
  DynamicBody skull, mandible;
  skull.surfaces = {std::make_shared<const ContactSurface>(
      make_contact_surface(upper, near_bite(jaws), threads))};
  mandible.surfaces = {std::make_shared<const ContactSurface>(
      make_contact_surface(lower, near_bite(jaws), threads))};
  mandible.mass = mass_properties(jaws.lower, bone_kg_mm3);
  mandible.X_WB.t.z() = -1;
  mandible.drag_N_s_mm = 2e-3;
  mandible.turning_drag_N_mm_s = 5;
  for (const int count : thread_counts(threads)) {
    RigidWorld world;
    const int c = world.add_body(skull), m = world.add_body(mandible);
    world.add_pair({.a = c, .b = m});
    for (const Vector3d& condyle : jaws.condyles)
      world.add_spring({.a = c,
                        .b = m,
                        .p_A = condyle,
                        .p_B = condyle,
                        .stiffness_N_mm = 10,
                        .damping_N_s_mm = 0.01});
    const int force = world.add_force({.body = m, .point = jaws.center});
    std::vector<Took> ms;
    int touching = 0, step = 0;
    for (int second = 0; second < seconds; ++second)
      ms.push_back(timed([&] {
        for (int i = 0; i < 1000; ++i, ++step) {
          world.set_force(force, {10 * std::sin(0.006 * step), 5 * std::sin(0.004 * step), 40});
          world.step(count);
          touching += !world.contacts().empty();
        }
      }));
    results.add("collide.dynamics", ms,
                {{"simulated_s", 1},
                 {"step_ms", 1},
                 {"triangles", upper.triangles.size()},
                 {"threads", count},
                 {"touching_steps_of_1000", touching / seconds}});
  }
}

std::uint64_t hash_of(const Pose& X, std::uint64_t before) {
  const std::array<double, 7> values = {X.R.x(), X.R.y(), X.R.z(), X.R.w(),
                                        X.t.x(), X.t.y(), X.t.z()};
  return hash_values(std::span<const double>(values), before);
}

/// Blocked frames as in the window's loop: the jaw is dragged into the bite, slides on all bones in
/// contact, and the exact surfaces verify the result.
void measure_blocked_jaw(const Case& patient, const Jaws& jaws, int threads, Results& results) {
  constexpr int frames = 240;
  constexpr double round = 2 * std::numbers::pi / frames;
  const ContactModel model(patient);
  model.prepare_sliding({}, threads);
  const auto shifted = [](double x, double y, double z) {
    return Pose{Eigen::Quaterniond::Identity(), {x, y, z}};
  };
  const auto circling = [&](int f) {
    return shifted(2.5 * std::sin(round * f), 0.5 * std::sin(2 * round * f), 1.5);
  };
  const auto grinding_jaw = [&](int f) {
    Pose X = shifted(0, 0, 0);
    X.R = Eigen::AngleAxisd(0.03 * std::sin(2 * round * f), Vector3d(0.3, 0.2, 1).normalized());
    const Vector3d middle = 0.5 * (jaws.condyles[0] + jaws.condyles[1]);
    X.t =
        Vector3d(3 * std::sin(round * f), 2 * std::sin(2 * round * f), 0.6) + middle - X.R * middle;
    return X;
  };
  const auto pushed_up = [&](int f) { return shifted(0.5, 0, 6 * std::sin(round * f)); };
  const std::pair<const char*, std::function<Pose(int)>> drags[] = {
      {"circling in the bite", circling}, {"grinding", grinding_jaw}, {"pushed up", pushed_up}};
  for (const int count : thread_counts(threads))
    for (const auto& [name, target] : drags) {
      std::vector<Took> ms;
      double deepest = 0;
      std::uint64_t poses = hash_start;
      BodyPoses at = model.placed({});
      ContactSet last = model.at_rest();
      for (int f = 0; f < frames; ++f) {
        ContactModel::Slide slide;
        const Took took = timed([&] {
          slide = model.slide(at, std::vector{Pose{}, target(f)}, &last, count);
        });
        at = slide.at;
        last = std::move(slide.contacts);
        poses = hash_of(at[mandible_body], poses);
        deepest = std::max(deepest, last.max_penetration_mm());
        if (slide.stopped) ms.push_back(took);
      }
      if (ms.empty()) continue;
      results.add("collide.blocked_jaw", ms,
                  {{"drag", name},
                   {"threads", count},
                   {"worst_depth_mm", deepest},
                   {"poses", fmt::format("{:016x}", poses)}});
    }
}

/// A recorded motion whose crowns overlap by up to 3 mm as the jaw grinds: the contacts of a frame.
/// Nothing stops it.
void measure_recorded_overlap(const Case& patient, const Jaws& jaws, int threads,
                              Results& results) {
  constexpr int frames = 240;
  constexpr double round = 2 * std::numbers::pi / frames;
  const ContactModel model(patient);
  for (const int count : thread_counts(threads)) {
    std::vector<Took> ms;
    double deepest = 0;
    std::uint64_t depths = hash_start;
    ContactSet last = model.at_rest();
    for (int f = 0; f < frames; ++f) {
      Pose X;
      X.R = Eigen::AngleAxisd(0.02 * std::sin(2 * round * f), Vector3d(0.3, 0.2, 1).normalized());
      X.t = jaws.center - X.R * jaws.center +
            Vector3d(2.5 * std::sin(round * f), 1.5 * std::sin(2 * round * f),
                     1 - std::cos(3 * round * f));
      ms.push_back(timed([&] { last = model.find(BodyPoses(X), &last, count); }));
      deepest = std::max(deepest, last.max_penetration_mm());
      for (const PairContact& pair : last.pairs)
        depths = hash_bytes(&pair.depth_mm, sizeof pair.depth_mm, depths);
    }
    results.add("collide.recorded_overlap", ms,
                {{"threads", count},
                 {"worst_depth_mm", deepest},
                 {"depths", fmt::format("{:016x}", depths)}});
  }
}

/// Muscle-driven chewing on food with the patient's own crowns: timed per simulated second, one
/// thread.
void measure_chewing(const Case& patient, Results& results) {
  constexpr int seconds = 5;
  constexpr double cycle_s = 0.7;
  MuscleJaw jaw(patient, {.bolus = {.side = BolusSettings::Side::right},
                          .hyoid = MuscleJawSettings::HyoidMode::fixed});
  std::vector<Took> ms;
  std::vector<double> excitations(jaw.muscles().size());
  double widest_mm = 0;
  const Vector3d incisor = *patient.landmarks.find("lower_incisal_point");
  for (int second = 0; second < seconds; ++second)
    ms.push_back(timed([&] {
      for (int i = 0; i < 1000; ++i) {
        const double phase = std::fmod(jaw.time_s() / cycle_s, 1.0);
        for (std::size_t m = 0; m < excitations.size(); ++m) {
          const bool closes = jaw.muscles()[m].group == "closer";
          excitations[m] =
              closes ? (phase > 0.45 && phase < 0.9 ? 0.1 : 0.01) : (phase < 0.4 ? 0.1 : 0.0);
        }
        jaw.step(excitations);
        widest_mm = std::max(widest_mm, incisor.z() - (jaw.pose() * incisor).z());
      }
    }));
  results.add("collide.chewing", ms,
              {{"simulated_s", 1},
               {"muscles", excitations.size()},
               {"widest_mm", widest_mm},
               {"threads", 1}});
}

/// Joints and contacts of the engine compared with plain Bullet's, one thread.
void measure_rigid(Results& results) {
  using Scene = std::pair<const char*, RigidRun (*)(RigidMethod)>;
  for (const auto& [scene, run] :
       {Scene{"chain of 4 on ball joints", swing_chain}, Scene{"block on a slope", slide_block}})
    for (const auto method : {RigidMethod::condyle, RigidMethod::bullet}) {
      const RigidRun r = run(method);
      Json row = {{"scene", scene},
                  {"method", method == RigidMethod::condyle ? "condyle" : "plain Bullet"},
                  {"threads", 1}};
      if (run == swing_chain)
        row.update({{"joint_error_mm", r.joint_error_mm},
                    {"energy_gain", r.energy_gain},
                    {"energy_loss", r.energy_loss}});
      else
        row.update(
            {{"depth_mm", r.depth_mm}, {"drift_mm", r.drift_mm}, {"slide_error", r.slide_error}});
      results.add("collide.rigid_step", r.step_ms, row);
    }
}

void measure_field(const Jaws& jaws, int threads, Results& results) {
  const TriMesh bone = sized(jaws.lower, 50000, jaws.center);
  const FieldSettings settings = near_bite(jaws).field;
  const auto folder = std::filesystem::temp_directory_path() /
                      fmt::format("condyle-bench-{}", static_cast<long>(getpid()));
  std::vector<Took> cold, kept;
  for (int i = 0; i < 3; ++i)
    cold.push_back(timed([&] { const DistanceField field(bone, settings, threads); }));
  std::filesystem::create_directories(folder);
  cached_field(folder, bone, settings, threads);
  for (int i = 0; i < 5; ++i)
    kept.push_back(timed([&] { cached_field(folder, bone, settings, threads); }));
  std::error_code none;
  std::filesystem::remove_all(folder, none);
  const Json parameters = {{"triangles", bone.triangles.size()},
                           {"spacing_mm", settings.spacing_mm},
                           {"threads", threads}};
  Json from = parameters;
  from["source"] = "cold";
  results.add("collide.field_build", cold, from);
  from["source"] = "disk cache";
  results.add("collide.field_build", kept, from);
}

}  // namespace

int run_bench_collide(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = open_patient(options.patient, common, bar);
  const Jaws jaws = find_jaws(patient);
  Results results;
  const auto part = [&](const char* name, double done, const auto& measure) {
    if (!options.part.empty() && options.part != name) return;
    bar.show(name, done);
    measure();
  };
  part("pair", 0.05, [&] {
    measure_pair(jaws, 50000, common.threads, true, results);
    measure_pair(jaws, 300000, common.threads, false, results);
  });
  part("blocked_jaw", 0.5, [&] { measure_blocked_jaw(patient, jaws, common.threads, results); });
  part("recorded_overlap", 0.55,
       [&] { measure_recorded_overlap(patient, jaws, common.threads, results); });
  part("segments", 0.6, [&] {
    for (const int threads : thread_counts(common.threads)) measure_segments(threads, results);
  });
  part("rigid_step", 0.65, [&] { measure_rigid(results); });
  part("field_build", 0.7, [&] { measure_field(jaws, common.threads, results); });
  part("dynamics", 0.8, [&] { measure_dynamics(jaws, common.threads, results); });
  part("chewing", 0.95, [&] { measure_chewing(patient, results); });
  bar.clear();

  Json json;
  json["machine"] = {{"processor", processor()}, {"cores", std::thread::hardware_concurrency()}};
  json["results"] = results.rows;
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  if (common.quiet) return 0;
  fmt::print(stderr, "median and 95th percentile in ms\n");
  for (const auto& row : results.rows) {
    std::string rest;
    for (const auto& [key, value] : row.items())
      if (key != "name" && key != "median" && key != "p95" && key != "unit")
        rest += fmt::format("  {} {}", key,
                            value.is_string() ? value.get<std::string>() : value.dump());
    fmt::print(stderr, "  {:<21}{:>10.3f}{:>10.3f}{}\n", row["name"].get<std::string>(),
               row["median"].get<double>(), row["p95"].get<double>(), rest);
  }
  return 0;
}

}  // namespace condyle
