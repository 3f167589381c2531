#include "tests/scenarios/support/slurm.hpp"

#include <arpa/inet.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <thread>

namespace hapbench::test {
namespace {

namespace fs = std::filesystem;

/// The file of a program of the system; empty when there is none.
fs::path file_of(const std::string& program) {
  for (const char* folder : {"/usr/bin", "/usr/sbin"}) {
    if (fs::exists(fs::path(folder) / program)) return fs::path(folder) / program;
  }
  return {};
}

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return std::string(name).substr(0, std::string(name).find('.'));
}

/// Jobs run as root: nobody else is to submit any.
std::string secret() {
  std::random_device random;
  std::string key(128, '\0');
  for (char& byte : key) byte = static_cast<char>(random());
  return key;
}

/// A port that nobody listens on now.
int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::socklen_t size = sizeof address;
  ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(socket);
  return ntohs(address.sin_port);
}

}  // namespace

std::string SlurmCluster::missing() {
  for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "setpriv"}) {
    if (file_of(program).empty()) return std::string(program) + " (scripts/setup --tests installs it)";
  }
  if (::geteuid() != 0) return "the rights of root, which the daemons need to start jobs";
  if (::getpwnam("munge") == nullptr) return "a user munge";
  return "";
}

SlurmCluster::SlurmCluster() {
  write_configuration();
  ::setenv("SLURM_CONF", (directory_ / "slurm.conf").c_str(), 1);
  const std::string munge = directory_ / "munge";
  start({"--reuid=munge", "--regid=munge", "--clear-groups", file_of("munged"), "--foreground",
         "--socket=" + munge + "/socket", "--key-file=" + munge + "/key", "--pid-file=" + munge + "/pid",
         "--seed-file=" + munge + "/seed", "--log-file=" + munge + "/log"});
  start({file_of("slurmctld"), "-D", "-i", "-L", directory_ / "slurmctld.log"});
  start({file_of("slurmd"), "-D", "-L", directory_ / "slurmd.log"});
  for (int attempt = 0; attempt < 1000; ++attempt) {
    if ((*this)("sinfo", {"--noheader", "--format=%T"}).out == "idle\n") return;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  throw std::runtime_error("the daemons of Slurm do not answer:\n" + logs());
}

SlurmCluster::~SlurmCluster() {
  (*this)("scancel", {"--full", "--signal=KILL", "--user=root"});
  daemons_.clear();
  ::unsetenv("SLURM_CONF");
}

ProgramRun SlurmCluster::operator()(const std::string& command, const std::vector<std::string>& arguments) const {
  return run_program(file_of(command), arguments);
}

/// Each daemon is killed when this process ends, however it ends.
void SlurmCluster::start(const std::vector<std::string>& words) {
  std::vector<std::string> all = {"--pdeathsig=KILL"};
  all.insert(all.end(), words.begin(), words.end());
  daemons_.push_back(std::make_unique<RunningProgram>(file_of("setpriv"), all));
}

void SlurmCluster::write_configuration() const {
  const fs::path munge = directory_ / "munge";
  for (const char* folder : {"munge", "state", "spool"}) fs::create_directory(directory_ / folder);
  write_plainly(munge / "key", secret());
  const ::passwd* user = ::getpwnam("munge");
  for (const fs::path& path : {munge, munge / "key"}) {
    if (::chown(path.c_str(), user->pw_uid, user->pw_gid) != 0) throw std::runtime_error("cannot give to munge");
  }
  fs::permissions(munge / "key", fs::perms::owner_read);
  for (const fs::path& path : {directory_.path(), munge}) {
    fs::permissions(path, fs::perms::owner_all | fs::perms::group_exec | fs::perms::others_exec |
                              fs::perms::group_read | fs::perms::others_read);
  }
  write_plainly(directory_ / "cgroup.conf", "CgroupPlugin=cgroup/v1\n");
  const std::string host = host_name(), here = directory_.path();
  write_plainly(directory_ / "slurm.conf",
                "ClusterName=hapbench\nSlurmctldHost=" + host + "(127.0.0.1)\nSlurmctldPort=" +
                    std::to_string(free_port()) + "\nSlurmdPort=" + std::to_string(free_port()) +
                    "\nSlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\nAuthInfo=socket=" + here +
                    "/munge/socket\nStateSaveLocation=" + here + "/state\nSlurmdSpoolDir=" + here +
                    "/spool\nSlurmctldPidFile=" + here + "/slurmctld.pid\nSlurmdPidFile=" + here +
                    "/slurmd.pid\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n"
                    "JobAcctGatherType=jobacct_gather/none\nMpiDefault=none\nSwitchType=switch/none\n"
                    "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\nReturnToService=2\n"
                    "SchedulerParameters=batch_sched_delay=0,sched_min_interval=0\n"
                    // As many as the test wants to run at once, whatever the machine has.
                    "SlurmdParameters=config_overrides\nNodeName=" +
                    host + " NodeAddr=127.0.0.1 CPUs=4 RealMemory=100 State=UNKNOWN\nPartitionName=main Nodes=" + host +
                    " Default=YES MaxTime=INFINITE State=UP\n");
}

std::string SlurmCluster::logs() const {
  std::string text;
  for (const char* log : {"munge/log", "slurmctld.log", "slurmd.log"}) {
    if (fs::exists(directory_ / log)) text += read_file(directory_ / log);
  }
  return text;
}

}  // namespace hapbench::test
