// MRPT's CRangeBearingKFSLAM2D on one robot of a MRCLAM data set, to compare with
// `haltline replay --format mrclam`. Prints the trajectory error and the time per update.
//
//   sudo apt-get install libmrpt-slam-dev   # Debian 12; part of libmrpt-dev
//   g++ -O2 -std=c++17 pilots/mrpt/kf_slam.cpp -o kf_slam -I/usr/include/eigen3 \
//       $(printf -- '-I%s ' /usr/include/mrpt/*/include) $(printf -- '-lmrpt-%s ' slam bayes obs \
//       maps img poses math config system rtti serialization containers core)
//   ./kf_slam MRCLAM_Dataset1 1
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/slam/CRangeBearingKFSLAM2D.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using Row = std::vector<double>;
using Point = std::array<double, 2>;

static std::vector<Row> rows(const std::string& path, size_t columns)
{
	std::ifstream file(path);
	if (!file) throw std::runtime_error(path + ": cannot be read");
	std::vector<Row> all;
	for (std::string line; std::getline(file, line);)
	{
		std::istringstream words(line.substr(0, line.find('#')));
		Row row;
		for (double value; words >> value;) row.push_back(value);
		if (row.size() == columns) all.push_back(row);
	}
	if (all.empty()) throw std::runtime_error(path + ": no rows");
	return all;
}

// Root mean square distance after the best rigid motion.
static double aligned_rms(const std::vector<std::pair<Point, Point>>& pairs)
{
	Point from{0, 0}, to{0, 0};
	for (const auto& [a, b] : pairs)
		for (int i = 0; i < 2; i++) from[i] += a[i] / pairs.size(), to[i] += b[i] / pairs.size();
	double dot = 0, cross = 0;
	for (const auto& [a, b] : pairs)
	{
		const double ax = a[0] - from[0], ay = a[1] - from[1], bx = b[0] - to[0], by = b[1] - to[1];
		dot += ax * bx + ay * by;
		cross += ax * by - ay * bx;
	}
	const double turn = std::atan2(cross, dot), c = std::cos(turn), s = std::sin(turn);
	double sum = 0;
	for (const auto& [a, b] : pairs)
	{
		const double ax = a[0] - from[0], ay = a[1] - from[1];
		sum += std::pow(c * ax - s * ay - (b[0] - to[0]), 2) + std::pow(s * ax + c * ay - (b[1] - to[1]), 2);
	}
	return std::sqrt(sum / pairs.size());
}

static double raw_rms(const std::vector<std::pair<Point, Point>>& pairs)
{
	double sum = 0;
	for (const auto& [a, b] : pairs) sum += std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2);
	return std::sqrt(sum / pairs.size());
}

static void run(const std::string& folder, const std::string& robot)
{
	const auto own = folder + "/Robot" + robot + "_";
	const auto commands = rows(own + "Odometry.dat", 3), seen = rows(own + "Measurement.dat", 4),
			   truth = rows(own + "Groundtruth.dat", 4);
	std::map<int, int> subjects;
	for (const auto& row : rows(folder + "/Barcodes.dat", 2)) subjects[int(row[1])] = int(row[0]);

	mrpt::slam::CRangeBearingKFSLAM2D filter;
	// It says of each new landmark that it did not expect it.
	filter.setMinLoggingLevel(mrpt::system::LVL_ERROR);
	filter.options.std_sensor_range = 0.13f;
	filter.options.std_sensor_yaw = 0.03f;
	mrpt::obs::CActionRobotMovement2D::TMotionModelOptions motion;
	motion.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
	motion.gaussianModel.a1 = 0.05f;
	motion.gaussianModel.a2 = 0.05f;
	motion.gaussianModel.a3 = 0.05f;
	motion.gaussianModel.a4 = 0.05f;
	motion.gaussianModel.minStdXY = 0.001f;
	motion.gaussianModel.minStdPHI = 0.001f;

	const auto first = std::find_if(
		truth.begin(), truth.end(), [&](const Row& row) { return row[0] >= commands[0][0]; });
	if (first == truth.end()) throw std::runtime_error("the true poses end before the odometry begins");
	const mrpt::poses::CPose2D start((*first)[1], (*first)[2], (*first)[3]);

	std::vector<std::pair<Point, Point>> pairs;
	std::vector<double> times;
	mrpt::poses::CPose2D since;
	size_t at = 0;
	for (size_t i = 0; i + 1 < commands.size(); i++)
	{
		const double span = std::min(1.0, commands[i + 1][0] - commands[i][0]);
		const double way = commands[i][1] * span, turn = commands[i][2] * span;
		const double sinc = std::abs(turn) < 1e-6 ? 1.0 : std::sin(turn / 2) / (turn / 2);
		since = since + mrpt::poses::CPose2D(
							way * sinc * std::cos(turn / 2), way * sinc * std::sin(turn / 2), turn);
		auto frame = mrpt::obs::CSensoryFrame::Create();
		auto sighting = mrpt::obs::CObservationBearingRange::Create();
		for (; at < seen.size() && seen[at][0] < commands[i + 1][0]; at++)
		{
			const auto subject = subjects.find(int(seen[at][1]));
			if (subject == subjects.end() || subject->second <= 5) continue;
			mrpt::obs::CObservationBearingRange::TMeasurement one;
			one.range = float(seen[at][2]);
			one.yaw = float(seen[at][3]);
			one.pitch = 0;
			one.landmarkID = subject->second;
			sighting->sensedData.push_back(one);
		}
		if (sighting->sensedData.empty()) continue;
		frame->insert(sighting);
		mrpt::obs::CActionRobotMovement2D moved;
		moved.computeFromOdometry(since, motion);
		auto actions = mrpt::obs::CActionCollection::Create();
		actions->insert(moved);
		since = mrpt::poses::CPose2D();
		const auto before = std::chrono::steady_clock::now();
		filter.processActionObservation(actions, frame);
		const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - before;
		times.push_back(took.count());
		mrpt::poses::CPosePDFGaussian estimate;
		filter.getCurrentRobotPose(estimate);
		const auto pose = start + estimate.mean;
		const auto now = std::lower_bound(
			truth.begin(), truth.end(), commands[i + 1][0], [](const Row& row, double t) { return row[0] < t; });
		if (now != truth.end() && (*now)[0] - commands[i + 1][0] < 0.5)
			pairs.push_back({{pose.x(), pose.y()}, {(*now)[1], (*now)[2]}});
	}
	if (pairs.empty()) throw std::runtime_error("no sighting of a landmark with a true pose: nothing to compare");
	std::sort(times.begin(), times.end());
	std::cout << "trajectory, raw      " << raw_rms(pairs) << " m rms\n"
			  << "trajectory, aligned  " << aligned_rms(pairs) << " m rms\n"
			  << "time per update      median " << times[times.size() / 2] << " us, longest " << times.back()
			  << " us, " << times.size() << " updates\n";
}

int main(int argc, char** argv)
{
	if (argc != 3)
	{
		std::cerr << "usage: kf_slam FOLDER ROBOT\n";
		return 2;
	}
	try
	{
		run(argv[1], argv[2]);
	}
	catch (const std::exception& error)
	{
		std::cerr << "error: " << error.what() << "\n";
		return 2;
	}
}
