#include "tests/tools/browser.hpp"

namespace test {

Outcome browse(const Folder& folder, const std::string& address) {
    return run(folder, {"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--user-data-dir=" + folder.file("profile"), "--host-resolver-rules=MAP * ~NOTFOUND",
                        "--enable-logging=stderr", "--virtual-time-budget=700", "--dump-dom", "file://" + address});
}

bool complains(const Outcome& outcome) { return outcome.err.find(":CONSOLE") != std::string::npos; }

}  // namespace test
