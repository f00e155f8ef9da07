// MuJoCo: tf_peer_mujoco CASE STEP. Contact points are small spheres on planes; joints in the plane x, z.
#include "tests/benchmarks/peers/common.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <mujoco/mujoco.h>
#include <string>
#include <unistd.h>

namespace {

constexpr double kRadius = 1e-3;

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string sphere(double x, double z) {
  return "<geom type=\"sphere\" size=\"" + number(kRadius) + "\" pos=\"" + number(x) + " 0 " + number(z) + "\" mass=\"0\"/>";
}

std::string inertia(double mass, double moment, double x = 0) {
  const std::string m = number(moment);
  return "<inertial pos=\"" + number(x) + " 0 0\" mass=\"" + number(mass) + "\" diaginertia=\"" + m + " " + m + " " + m + "\"/>";
}

// Angles turn from x to z.
std::string hinge(double damping = 0) { return "<joint type=\"hinge\" axis=\"0 -1 0\" damping=\"" + number(damping) + "\"/>"; }
std::string slides() { return "<joint type=\"slide\" axis=\"1 0 0\"/><joint type=\"slide\" axis=\"0 0 1\"/>"; }

std::string world(double mu, double step, const std::string &planes, const std::string &bodies) {
  return "<mujoco><compiler angle=\"radian\" boundmass=\"0\" boundinertia=\"0\"/><size njmax=\"2000\" nconmax=\"400\"/><option "
         "timestep=\"" +
         number(step) +
         "\" gravity=\"0 0 -9.81\" cone=\"elliptic\"/><default><geom condim=\"3\" contype=\"1\" conaffinity=\"2\" friction=\"" +
         number(mu) + " 0 0\"/></default><worldbody>" + planes + bodies + "</worldbody></mujoco>";
}

std::string plane(double height, int up) {
  return "<geom type=\"plane\" size=\"0 0 1\" contype=\"2\" conaffinity=\"1\" pos=\"0 0 " + number(height - up * kRadius) +
         "\" zaxis=\"0 0 " + std::to_string(up) + "\"/>";
}

struct Problem {
  std::string xml;
  double end = 0;
  std::vector<double> q, v;
};

Problem box(double step) {
  const std::string corners = sphere(-0.5, -0.3) + sphere(0.5, -0.3) + sphere(0.5, 0.3) + sphere(-0.5, 0.3);
  return {world(0.2, step, plane(0, 1), "<body>" + inertia(1, 1.36 / 12) + slides() + hinge() + corners + "</body>"),
          2,
          {0, 1, 0.9},
          {3, 0, 4}};
}

Problem rod(double step) {
  const double quarter = std::acos(-1.0) / 4;
  return {
      world(0.3, step, plane(0, 1), "<body>" + inertia(1, 1.0 / 12) + slides() + hinge() + sphere(-0.5, 0) + sphere(0.5, 0) + "</body>"),
      1.5,
      {0, 0.5 * std::sin(quarter) + 0.5, quarter},
      {2, 0, 0}};
}

// Joint angles are relative to the body before.
Problem sliderCrank(double step) {
  const std::string slider = "<body pos=\"0.306 0 0\">" + inertia(0.076, 2.7e-6) + hinge() + sphere(-0.05, 0.025) + sphere(0.05, 0.025) +
                             sphere(-0.05, -0.025) + sphere(0.05, -0.025) + "</body>";
  const std::string rod = "<body pos=\"0.153 0 0\">" + inertia(0.038, 5.9e-4, 0.153) + hinge() + slider + "</body>";
  const std::string crank = "<body>" + inertia(0.038, 7.4e-5, 0.0765) + hinge() + rod + "</body>";
  return {world(0.01, step, plane(-0.026, 1) + plane(0.026, -1), crank), 0.1, {0, 0, 0}, {150, -225, 75}};
}

Problem chain(double step) {
  constexpr int links = 50;
  constexpr double length = 1.0 / links, mass = 1.0 / links, damping = 0.002;
  std::string body;
  Problem problem;
  problem.q = {0, 0.3, 0.9};
  for (int i = links - 1; i >= 0; --i) {
    const std::string joints = i == 0 ? slides() + hinge() : hinge(damping);
    const std::string place = i == 0 ? "" : " pos=\"" + number(length) + " 0 0\"";
    body = "<body" + place + ">" + inertia(mass, mass * length * length / 12, length / 2) + joints + (i == 0 ? sphere(0, 0) : "") +
           sphere(length, 0) + body + "</body>";
  }
  problem.q.resize(links + 2, -0.25);
  problem.v.resize(links + 2, 0.0);
  problem.v[0] = 0.5;
  problem.end = 1;
  problem.xml = world(0.5, step, plane(0, 1), body);
  return problem;
}

mjModel *load(const std::string &xml) {
  std::string path = (std::filesystem::temp_directory_path() / "tf-peer-XXXXXX").string();
  const int file = mkstemp(path.data());
  if (file < 0 || write(file, xml.data(), xml.size()) != static_cast<ssize_t>(xml.size())) {
    return nullptr;
  }
  close(file);
  char error[500] = "";
  mjModel *model = mj_loadXML(path.c_str(), nullptr, error, sizeof error);
  unlink(path.c_str());
  if (model == nullptr) {
    std::fprintf(stderr, "%s\n", error);
  }
  return model;
}

std::vector<double> run(const Problem &problem, const mjModel *model, double step, bool relative) {
  mjData *data = mj_makeData(model);
  std::copy(problem.q.begin(), problem.q.end(), data->qpos);
  std::copy(problem.v.begin(), problem.v.end(), data->qvel);
  const long steps = std::lround(problem.end / step);
  const double start = tf::peers::cpuSeconds();
  for (long k = 0; k < steps; ++k) {
    mj_step(model, data);
  }
  std::vector<double> result = {tf::peers::cpuSeconds() - start};
  double sum = 0;
  for (int i = 0; i < model->nq; ++i) {
    sum = relative ? sum + data->qpos[i] : data->qpos[i];
    result.push_back(sum);
  }
  mj_deleteData(data);
  return result;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc != 3) {
    return 2;
  }
  const std::string name = argv[1];
  const double step = std::atof(argv[2]);
  Problem problem;
  if (name == "box") {
    problem = box(step);
  } else if (name == "rod") {
    problem = rod(step);
  } else if (name == "slider-crank") {
    problem = sliderCrank(step);
  } else if (name == "chain") {
    problem = chain(step);
  } else {
    return 1;
  }
  mjModel *model = load(problem.xml);
  if (model == nullptr) {
    return 1;
  }
  return tf::peers::answer([&] { return run(problem, model, step, name == "slider-crank"); });
}
