// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/wall_contact.hpp"

#include "spot/base/errors.hpp"

namespace spot {

void WallContacts::add(const WallContact& contact) {
  if (size_ == capacity) throw InvalidContainer(message("more than ", capacity, " walls are close to one grain"));
  contacts_[size_++] = contact;
}

}  // namespace spot
