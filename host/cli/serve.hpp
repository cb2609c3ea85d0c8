// serve.hpp - a web server for this machine alone.
#pragma once

#include <functional>

#include "facezip/landmarks.hpp"
#include "facezip/package.hpp"
#include "facezip/progress.hpp"

namespace facezip::cli {

/// Serves the viewer of `package` on 127.0.0.1, and nothing but the page and the files that package.json names, until
/// `progress` is cancelled; then it returns.
/// port     0: any that is free
/// started  called with the port, once connections are accepted
/// Throws InputError when the port cannot be had.
void serveViewer(const Package& package, int port, const std::function<void(int port)>& started, Progress& progress);

/// Serves a page to place the landmarks of `session`, which it may save; otherwise as above.
void serveLandmarks(const LandmarkSession& session, int port, const std::function<void(int port)>& started,
                    Progress& progress);

}  // namespace facezip::cli
