// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/kept_contact.hpp"

namespace suture {

void KeptContact::change_sleepers(const LiveMask& moving) {
  const auto moves = [&](const ContactLaw::Press& press) {
    return moving[press[0]] || moving[press[1]];
  };
  std::erase_if(presses_asleep, moves);
  std::erase_if(pair_presses, moves);
  presses_asleep.insert(presses_asleep.end(), pair_presses.begin(), pair_presses.end());
  pair_presses.clear();
}

void KeptContact::state_of_pairs(Archive& archive) {
  archive.rows<Index>("presses", pair_presses);
  archive.rows<Index>("presses of sleepers", presses_asleep);
  archive.member("pushed sleepers", pushed_sleepers, &PushedSleeper::vertex);
  archive.member("their accelerations", pushed_sleepers, &PushedSleeper::acceleration);
}

}  // namespace suture
