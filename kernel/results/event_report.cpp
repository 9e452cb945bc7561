// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/event_report.hpp"

#include <sstream>

#include "kernel/base/message_text.hpp"

namespace suture {
std::string event_line(const EventOutcome& outcome, double time, Index islands) {
  return timed(time, outcome.text() + ", " + count_text(islands, "island"));
}

EventReport::EventReport(const std::vector<Event>& events)
    : events_(events), gathered_(events.size()) {}

std::vector<std::string> EventReport::add(std::size_t i, const EventOutcome& outcome, double time,
                                          Index islands) {
  std::vector<std::string> lines;
  Gathered& own = gathered_[i];
  const bool is_due = !events_[i].repeats() || !own.began || islands != islands_;
  for (Gathered& other : gathered_)
    if (is_due && &other != &own) flush(other, lines);
  own.began = true;
  islands_ = islands;
  if (own.steps++ == 0) own.first = time;
  own.last = time;
  own.outcome += outcome;
  if (is_due) flush(own, lines);
  return lines;
}

std::vector<std::string> EventReport::finish() {
  std::vector<std::string> lines;
  for (Gathered& gathered : gathered_) flush(gathered, lines);
  return lines;
}

void EventReport::flush(Gathered& gathered, std::vector<std::string>& lines) const {
  if (gathered.steps == 1) {
    lines.push_back(event_line(gathered.outcome, gathered.last, islands_));
  } else if (gathered.steps > 1) {
    std::ostringstream line;
    line << "t = " << gathered.first << " to " << gathered.last << " s: " << gathered.outcome.text()
         << " in " << gathered.steps << " steps, " << count_text(islands_, "island");
    lines.push_back(line.str());
  }
  gathered.steps = 0;
  gathered.outcome = {};
}

void EventReport::state(Archive& archive) {
  std::span gathered = gathered_;
  archive.each("gathered", gathered, [](Archive& each, Gathered& g) {
    each("outcome", g.outcome);
    each("first", g.first);
    each("last", g.last);
    each("steps", g.steps);
    each("began", g.began);
  });
  archive("islands", islands_);
}

}  // namespace suture
