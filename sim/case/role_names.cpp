#include <array>
#include <utility>

#include "sim/case/case_io.h"

namespace condyle {
namespace {

constexpr std::array<std::pair<Role, const char*>, 12> roles = {{
    {Role::skull, "skull"},
    {Role::maxilla, "maxilla"},
    {Role::mandible, "mandible"},
    {Role::upper_teeth, "upper-teeth"},
    {Role::lower_teeth, "lower-teeth"},
    {Role::face, "face"},
    {Role::eyes, "eyes"},
    {Role::upper_gums, "upper-gums"},
    {Role::lower_gums, "lower-gums"},
    {Role::tongue, "tongue"},
    {Role::segment, "segment"},
    {Role::transplant, "transplant"},
}};

}  // namespace

std::string role_name(Role role) {
  for (const auto& [known, name] : roles)
    if (known == role) return name;
  return "";
}

std::optional<Role> role_named(const std::string& name) {
  for (const auto& [role, known] : roles)
    if (name == known) return role;
  return std::nullopt;
}

std::string known_roles() {
  std::string list;
  for (const auto& [role, name] : roles) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

}  // namespace condyle
