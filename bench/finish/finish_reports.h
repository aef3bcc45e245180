// The two things that finish_bench prints.
#pragma once

#include <string>

#include "bench/finish/finish_work.h"
#include "bench/performance/figures.h"
#include "bench/performance/repeats.h"

namespace scumble::bench {

// Times of each effect and preset whose name has `part` in it, as a table.
Status PrintFinishTable(const FinishWork& work, int runs, const std::string& part);

// 9: the ratios that have targets, each of contenders that take turns.
Status MeasureFinishRatios(const FinishWork& work, RepeatOptions repeats, Report& report);

}  // namespace scumble::bench
