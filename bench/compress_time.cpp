// compress_time - the whole job beside what it cannot do without: decoding the same images with OpenImageIO.
//   compress_time CAPTURE PACKAGE [--repeats N] [--out FILE.json] [-- OPTIONS OF facezip compress]
// Each repeat decodes every texture of the capture on all cores, then runs `facezip compress` as a process of its own;
// the ratio of the two times is taken within a repeat, so that a machine that others use disturbs both alike.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "facezip/capture.hpp"

extern char** environ;

namespace facezip::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Arguments {
  fs::path capture;
  fs::path package;
  int repeats = 5;
  std::string out;
  std::vector<std::string> options;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  std::vector<std::string> folders;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--") {
      arguments.options.assign(argv + i + 1, argv + argc);
      break;
    }
    if (word == "--repeats" && i + 1 < argc) {
      arguments.repeats = std::stoi(argv[++i]);
    } else if (word == "--out" && i + 1 < argc) {
      arguments.out = argv[++i];
    } else {
      folders.push_back(word);
    }
  }
  if (folders.size() != 2 || arguments.repeats < 1) {
    throw std::invalid_argument("usage: compress_time CAPTURE PACKAGE [--repeats N] [--out FILE.json] [-- OPTIONS]");
  }
  arguments.capture = folders[0];
  arguments.package = folders[1];
  return arguments;
}

std::vector<fs::path> texturesOf(const Capture& capture) {
  std::vector<fs::path> files;
  for (const CaptureMap& map : capture.maps) {
    files.push_back(map.neutral);
    files.insert(files.end(), map.expressions.begin(), map.expressions.end());
  }
  return files;
}

void decode(const fs::path& file) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw std::runtime_error(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  std::vector<std::byte> samples(spec.image_bytes(/* native= */ true));
  if (!input->read_image(0, 0, 0, spec.nchannels, spec.format, samples.data())) {
    throw std::runtime_error(input->geterror());
  }
}

/// Wall seconds of decoding every texture once, images side by side.
double decodeAll(const std::vector<fs::path>& files) {
  const auto start = Clock::now();
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) { decode(files[i]); });
  return secondsSince(start);
}

struct Run {
  double seconds = 0.0;
  double processor_seconds = 0.0;
  double peak_mebibytes = 0.0;
};

Run compress(const Arguments& arguments) {
  std::vector<std::string> words = {FACEZIP_COMMAND, "compress", arguments.capture.string(), "--output",
                                    arguments.package.string()};
  words.insert(words.end(), arguments.options.begin(), arguments.options.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  ::posix_spawn_file_actions_init(&quiet);
  ::posix_spawn_file_actions_addopen(&quiet, 1, "/dev/null", 1, 0);
  const auto start = Clock::now();
  pid_t child = 0;
  if (::posix_spawn(&child, FACEZIP_COMMAND, &quiet, nullptr, argv.data(), environ) != 0) {
    throw std::runtime_error("cannot run " FACEZIP_COMMAND);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  const double seconds = secondsSince(start);
  ::posix_spawn_file_actions_destroy(&quiet);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("facezip compress failed");
  const auto processor = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds, processor(usage.ru_utime) + processor(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  const std::vector<fs::path> files = texturesOf(openCapture(arguments.capture));
  decodeAll(files);     // warms the page cache
  compress(arguments);  // and the caches of compiled kernels
  std::vector<double> ratios;
  nlohmann::json rows = nlohmann::json::array();
  std::printf("decode s  compress s  ratio  processor s  peak MiB\n");
  for (int i = 0; i < arguments.repeats; ++i) {
    const double before = decodeAll(files);
    const Run job = compress(arguments);
    const double decoding = 0.5 * (before + decodeAll(files));
    ratios.push_back(job.seconds / decoding);
    std::printf("%8.2f  %10.2f  %5.2f  %11.2f  %8.0f\n", decoding, job.seconds, ratios.back(), job.processor_seconds,
                job.peak_mebibytes);
    std::fflush(stdout);
    rows.push_back({{"decode_seconds", decoding},
                    {"compress_seconds", job.seconds},
                    {"ratio", ratios.back()},
                    {"processor_seconds", job.processor_seconds},
                    {"peak_mebibytes", job.peak_mebibytes}});
  }
  std::printf("median ratio %.2f over %d repeats\n", median(ratios), arguments.repeats);
  if (!arguments.out.empty()) {
    std::ofstream(arguments.out) << nlohmann::json{{"median_ratio", median(ratios)}, {"repeats", rows}}.dump(2) << '\n';
  }
  return 0;
}

}  // namespace
}  // namespace facezip::bench

int main(int argc, char** argv) {
  try {
    return facezip::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compress_time: %s\n", error.what());
    return 1;
  }
}
