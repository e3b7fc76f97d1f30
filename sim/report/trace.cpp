#include "sim/report/trace.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"

namespace condyle {

const char* TraceWriter::header() {
  return "frame,time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,incisor_x_mm,incisor_y_mm,incisor_z_mm,"
         "opening_mm,interincisal_mm,rotation_deg,left_condyle_x_mm,left_condyle_y_mm,"
         "left_condyle_z_mm,right_condyle_x_mm,right_condyle_y_mm,right_condyle_z_mm,contacts,"
         "min_clearance_mm,max_penetration_mm,tissue_iterations,tissue_energy,tissue_residual,"
         "inverted_prisms,motion_ms,contact_ms,tissue_ms,render_ms,state_hash,stopped,protrusion_"
         "mm,"
         "laterotrusion_mm,midline_deviation_mm,left_condyle_travel_mm,right_condyle_travel_mm,"
         "condyle_asymmetry_mm,helical_axis_x,helical_axis_y,helical_axis_z,helical_point_x_mm,"
         "helical_point_y_mm,helical_point_z_mm,helical_slide_mm,incisor_speed_mm_s,tissue_"
         "penetration_mm,"
         "tissue_slip_mm,tissue_kept,tissue_converged,tissue_contact_error_mm";
}

TraceWriter::TraceWriter(const std::filesystem::path& file, const std::vector<std::string>& muscles,
                         const BodyTree& bodies, const JawBodies& jaw)
    : file_(file),
      beside_(file.parent_path() / ("." + file.filename().string() + ".part")),
      jaw_(jaw.lower_arch) {
  stream_ = std::fopen(beside_.c_str(), "wb");
  if (!stream_) throw MachineError(file_.string() + ": cannot be written: " + std::strerror(errno));
  std::string columns = header();
  for (const auto& name : muscles)
    columns += fmt::format(",{0}_excitation,{0}_length_mm,{0}_force_N", name);
  for (int b = 1; b < bodies.size(); ++b) {
    const BodyId body{b};
    if (body == jaw_) continue;
    others_.push_back(body);
    columns += fmt::format(",{0}_tx_mm,{0}_ty_mm,{0}_tz_mm,{0}_qw,{0}_qx,{0}_qy,{0}_qz",
                           bodies[body].name);
  }
  put(columns + "\n");
}

TraceWriter::~TraceWriter() {
  if (!stream_) return;
  std::fclose(stream_);
  ::unlink(beside_.c_str());
}

void TraceWriter::put(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size())
    throw MachineError(file_.string() + ": cannot be written: " + std::strerror(errno));
}

void TraceWriter::add(int frame, const FrameState& s) {
  const auto& m = s.measures;
  const auto& q = s.poses[jaw_].R;
  std::string row = std::to_string(frame);
  const auto numbers = [&row](std::initializer_list<double> values) {
    for (const double value : values) row += std::isfinite(value) ? fmt::format(",{}", value) : ",";
  };
  const auto point = [&](const Eigen::Vector3d& p) { numbers({p.x(), p.y(), p.z()}); };
  const auto count = [&row](int value) { row += fmt::format(",{}", value); };
  const auto ms = [&row](double value) { row += fmt::format(",{:.4f}", value); };

  numbers({s.time_s});
  point(s.poses[jaw_].t);
  numbers({q.w(), q.x(), q.y(), q.z()});
  point(m.incisor);
  numbers({m.opening_mm, m.interincisal_mm, m.rotation_deg});
  point(m.left_condyle);
  point(m.right_condyle);
  count(s.contacts.contact_count());
  numbers({s.contacts.min_clearance_mm(), s.contacts.max_penetration_mm()});
  count(s.tissue.iterations);
  numbers({s.tissue.energy, s.tissue.residual});
  count(s.tissue.inverted_prisms);
  ms(s.times[Stage::motion]);
  ms(s.times[Stage::contact]);
  ms(s.times[Stage::tissue] + s.times[Stage::face]);
  ms(s.times[Stage::render]);
  row += fmt::format(",{:016x}", s.state_hash);
  count(s.stopped ? 1 : 0);
  numbers({m.protrusion_mm, m.laterotrusion_mm, m.midline_deviation_mm, m.left_condyle_travel_mm,
           m.right_condyle_travel_mm, m.left_condyle_travel_mm - m.right_condyle_travel_mm});
  if (m.helical_axis.known) {
    point(m.helical_axis.direction);
    point(m.helical_axis.point);
    numbers({m.helical_axis.slide_mm});
  } else {
    row += ",,,,,,,";
  }
  const double since = s.time_s - before_s_;
  numbers({rows_ > 0 && since > 0 ? (m.incisor - incisor_before_).norm() / since : 0.0});
  before_s_ = s.time_s;
  incisor_before_ = m.incisor;
  ++rows_;
  numbers({s.tissue.penetration_mm, s.tissue.slip_mm});
  count(s.tissue.reused ? 1 : 0);
  count(s.tissue.converged ? 1 : 0);
  numbers({s.tissue.contact_error_mm});
  for (const MuscleState& muscle : s.muscles)
    numbers({muscle.excitation, muscle.length_mm, muscle.force_N});
  for (const BodyId body : others_) {
    const Pose& X_CB = s.poses[body];
    point(X_CB.t);
    numbers({X_CB.R.w(), X_CB.R.x(), X_CB.R.y(), X_CB.R.z()});
  }
  put(row + "\n");
}

void TraceWriter::finish() {
  const bool flushed = std::fflush(stream_) == 0;
  const int reason = errno;
  const bool closed = std::fclose(stream_) == 0;
  stream_ = nullptr;
  if (!flushed || !closed || ::rename(beside_.c_str(), file_.c_str()) != 0) {
    const int why = flushed ? errno : reason;
    ::unlink(beside_.c_str());
    throw MachineError(file_.string() + ": cannot be written: " + std::strerror(why));
  }
}

}  // namespace condyle
