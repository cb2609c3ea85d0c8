// report_page.hpp - the page around a report, compiled in (host/report).
#pragma once

#include <map>
#include <string_view>

namespace facezip::report {

const std::map<std::string_view, std::string_view>& embeddedReportPage();

}  // namespace facezip::report
