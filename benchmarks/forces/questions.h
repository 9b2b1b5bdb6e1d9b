// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/report.h"

namespace bench {

/// Flop/s and bytes/s of the forces of a lattice against those that one core reaches.
///
/// machine  chains of multiply-adds in registers, in single and double precision; a triad a = b + s c whose arrays fit
///          into the second-level cache, possibly into the last-level cache, and into none
/// forces   the kernel of cells alone and a whole evaluation, neo-Hookean with the energy of the modes, on balls:
///          operations and bytes of force_counts.h over the median time; in turns with the chains of multiply-adds, so
///          that the percentages refer to the same minute
///
/// One thread. --target: this instruction set instead of the best one of the machine.
void compareWithLimit(const Options &options, Report &report);

/// The cost of a fork-join, and the speed-up of a step of 3 000 phyxels on --threads threads (2 by default).
///
/// fork-join  loops of 0, 10, 50 and 200 µs of work (arithmetic without memory), one after the other and with 30 µs of
///            work of the caller alone in between (subtracted), serial, by c3de::ThreadPool, and by oneTBB's
///            parallel_for (static and automatic partitioner) if it was present at build time
/// steps      forces and explicit substeps of balls
///
/// All in turns. "median" is the time at the present load of the machine; "1 %" is the first percentile, the time
/// without other load: under other load a second thread is not available half of the time. speed-up: serial over
/// parallel, each of both.
void measureThreads(const Options &options, Report &report);

}  // namespace bench
