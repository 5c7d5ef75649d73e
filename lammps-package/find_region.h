// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_FIND_REGION_H
#define SPOT_FIND_REGION_H

#include <string>

namespace LAMMPS_NS {

/// The region with this ID, or a null pointer. Domain says where it is since 4 May 2022, and before that its number in
/// an array; the last argument, 0, prefers the first of the two where a Domain has it.
template <typename Domain>
auto find_region(Domain &domain, const std::string &id, int) -> decltype(domain.get_region_by_id(id)) {
  return domain.get_region_by_id(id);
}

template <typename Domain>
auto find_region(Domain &domain, const std::string &id, long) -> decltype(+domain.regions[domain.find_region(id)]) {
  const int index = domain.find_region(id);
  return index < 0 ? nullptr : domain.regions[index];
}

}  // namespace LAMMPS_NS

#endif
