// gnuplot as a child process.
#pragma once
#include <string>

namespace nephroid::chart {

// What gnuplot prints for a script that sets its terminal and no output. Needs no shell, no settings of the user's and no files of a name. Throws
// std::runtime_error, one line, where there is no gnuplot, or it complains.
std::string run_gnuplot(const std::string& script);

// Throws as above where there is none: before anything is measured that it is to draw.
void check_gnuplot();

}  // namespace nephroid::chart
