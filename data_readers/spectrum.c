/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/spectrum.h"
#include <math.h>

enum { FIRST_NM = 380, LAST_NM = 780, STEP_NM = 5, ROWS = (LAST_NM - FIRST_NM) / STEP_NM + 1 };

/* x, y, z of the standard observer and the power of D65, from 380 nm on. */
static const double table[ROWS][4] = {
	{0.001368, 0.000039, 0.006450, 49.9755},  {0.002236, 0.000064, 0.010550, 52.3118},
	{0.004243, 0.000120, 0.020050, 54.6482},  {0.007650, 0.000217, 0.036210, 68.7015},
	{0.014310, 0.000396, 0.067850, 82.7549},  {0.023190, 0.000640, 0.110200, 87.1204},
	{0.043510, 0.001210, 0.207400, 91.4860},  {0.077630, 0.002180, 0.371300, 92.4589},
	{0.134380, 0.004000, 0.645600, 93.4318},  {0.214770, 0.007300, 1.039050, 90.0570},
	{0.283900, 0.011600, 1.385600, 86.6823},  {0.328500, 0.016840, 1.622960, 95.7736},
	{0.348280, 0.023000, 1.747060, 104.8650}, {0.348060, 0.029800, 1.782600, 110.9360},
	{0.336200, 0.038000, 1.772110, 117.0080}, {0.318700, 0.048000, 1.744100, 117.4100},
	{0.290800, 0.060000, 1.669200, 117.8120}, {0.251100, 0.073900, 1.528100, 116.3360},
	{0.195360, 0.090980, 1.287640, 114.8610}, {0.142100, 0.112600, 1.041900, 115.3920},
	{0.095640, 0.139020, 0.812950, 115.9230}, {0.057950, 0.169300, 0.616200, 112.3670},
	{0.032010, 0.208020, 0.465180, 108.8110}, {0.014700, 0.258600, 0.353300, 109.0820},
	{0.004900, 0.323000, 0.272000, 109.3540}, {0.002400, 0.407300, 0.212300, 108.5780},
	{0.009300, 0.503000, 0.158200, 107.8020}, {0.029100, 0.608200, 0.111700, 106.2960},
	{0.063270, 0.710000, 0.078250, 104.7900}, {0.109600, 0.793200, 0.057250, 106.2390},
	{0.165500, 0.862000, 0.042160, 107.6890}, {0.225750, 0.914850, 0.029840, 106.0470},
	{0.290400, 0.954000, 0.020300, 104.4050}, {0.359700, 0.980300, 0.013400, 104.2250},
	{0.433450, 0.994950, 0.008750, 104.0460}, {0.512050, 1.000000, 0.005750, 102.0230},
	{0.594500, 0.995000, 0.003900, 100.0000}, {0.678400, 0.978600, 0.002750, 98.1671},
	{0.762100, 0.952000, 0.002100, 96.3342},  {0.842500, 0.915400, 0.001800, 96.0611},
	{0.916300, 0.870000, 0.001650, 95.7880},  {0.978600, 0.816300, 0.001400, 92.2368},
	{1.026300, 0.757000, 0.001100, 88.6856},  {1.056700, 0.694900, 0.001000, 89.3459},
	{1.062200, 0.631000, 0.000800, 90.0062},  {1.045600, 0.566800, 0.000600, 89.8026},
	{1.002600, 0.503000, 0.000340, 89.5991},  {0.938400, 0.441200, 0.000240, 88.6489},
	{0.854450, 0.381000, 0.000190, 87.6987},  {0.751400, 0.321000, 0.000100, 85.4936},
	{0.642400, 0.265000, 0.000050, 83.2886},  {0.541900, 0.217000, 0.000030, 83.4939},
	{0.447900, 0.175000, 0.000020, 83.6992},  {0.360800, 0.138200, 0.000010, 81.8630},
	{0.283500, 0.107000, 0, 80.0268},         {0.218700, 0.081600, 0, 80.1207},
	{0.164900, 0.061000, 0, 80.2146},         {0.121200, 0.044580, 0, 81.2462},
	{0.087400, 0.032000, 0, 82.2778},         {0.063600, 0.023200, 0, 80.2810},
	{0.046770, 0.017000, 0, 78.2842},         {0.032900, 0.011920, 0, 74.0027},
	{0.022700, 0.008210, 0, 69.7213},         {0.015840, 0.005723, 0, 70.6652},
	{0.011359, 0.004102, 0, 71.6091},         {0.008111, 0.002929, 0, 72.9790},
	{0.005790, 0.002091, 0, 74.3490},         {0.004109, 0.001484, 0, 67.9765},
	{0.002899, 0.001047, 0, 61.6040},         {0.002049, 0.000740, 0, 65.7448},
	{0.001440, 0.000520, 0, 69.8856},         {0.001000, 0.000361, 0, 72.4863},
	{0.000690, 0.000249, 0, 75.0870},         {0.000476, 0.000172, 0, 69.3398},
	{0.000332, 0.000120, 0, 63.5927},         {0.000235, 0.000085, 0, 55.0054},
	{0.000166, 0.000060, 0, 46.4182},         {0.000117, 0.000042, 0, 56.6118},
	{0.000083, 0.000030, 0, 66.8054},         {0.000059, 0.000021, 0, 65.0941},
	{0.000042, 0.000015, 0, 63.3828},
};

static const double xyz_to_rgb[3][3] = {
	{3.2404542, -1.5371385, -0.4985314},
	{-0.9692660, 1.8760108, 0.0415560},
	{0.0556434, -0.2040259, 1.0572252},
};

bool spectrum_has_colour(const double *nm, size_t n)
{
	return n >= 3 && nm[0] <= 450 && nm[n - 1] >= 650;
}

void spectrum_xyz_to_rgb(const double xyz[3], double rgb[3])
{
	for (int c = 0; c < 3; c++)
		rgb[c] = xyz_to_rgb[c][0] * xyz[0] + xyz_to_rgb[c][1] * xyz[1] + xyz_to_rgb[c][2] * xyz[2];
}

/* What power at this wavelength, FIRST_NM to LAST_NM, adds to the channels. */
static void response(int nm, double rgb[3])
{
	const int row = nm < LAST_NM ? (nm - FIRST_NM) / STEP_NM : ROWS - 2;
	const double share = (nm - FIRST_NM - row * STEP_NM) / (double)STEP_NM;
	double value[4];
	for (int i = 0; i < 4; i++)
		value[i] = (1 - share) * table[row][i] + share * table[row + 1][i];
	const double xyz[3] = {value[3] * value[0], value[3] * value[1], value[3] * value[2]};
	spectrum_xyz_to_rgb(xyz, rgb);
}

static bool rises(const double *nm, size_t n)
{
	for (size_t j = 0; j < n; j++)
		if (!isfinite(nm[j]) || nm[j] <= (j ? nm[j - 1] : 0))
			return false;
	return n > 0;
}

enum status spectrum_weights(const double *nm, size_t n, double *weight)
{
	double sum[3] = {0, 0, 0};
	size_t j = 0; /* the last wavelength that is not above the one looked at; the first if there is none */
	if (!rises(nm, n))
		return STATUS_DOMAIN;
	const bool colour = spectrum_has_colour(nm, n);
	for (size_t i = 0; i < 3 * n; i++)
		weight[i] = colour ? 0 : 1 / (double)n;
	for (int at = FIRST_NM; at <= LAST_NM && colour; at++) {
		double rgb[3];
		while (j + 1 < n && nm[j + 1] <= at)
			j++;
		const bool between = nm[j] <= at && j + 1 < n;
		const double share = between ? (at - nm[j]) / (nm[j + 1] - nm[j]) : 0;
		response(at, rgb);
		for (size_t c = 0; c < 3; c++) {
			weight[c * n + j] += (1 - share) * rgb[c];
			if (between)
				weight[c * n + j + 1] += share * rgb[c];
			sum[c] += rgb[c];
		}
	}
	for (size_t i = 0; i < 3 * n && colour; i++)
		weight[i] /= sum[i / n];
	return STATUS_OK;
}

void spectrum_rgb(const double *weight, const double *value, size_t n, double rgb[3])
{
	for (size_t c = 0; c < 3; c++) {
		rgb[c] = 0;
		for (size_t j = 0; j < n; j++)
			rgb[c] += weight[c * n + j] * value[j];
	}
}

const double spectrum_band_nm[2 * SPECTRUM_BANDS] = {380, 490, 500, 585, 595, 780};

enum status spectrum_bands(struct spectrum_bands *bands)
{
	double weight[3 * 2 * SPECTRUM_BANDS], determinant = 0;
	const enum status status = spectrum_weights(spectrum_band_nm, (size_t)2 * SPECTRUM_BANDS, weight);
	if (status != STATUS_OK)
		return status;
	for (int c = 0; c < 3; c++)
		for (int b = 0; b < SPECTRUM_BANDS; b++)
			bands->to_rgb[c][b] =
				weight[2 * SPECTRUM_BANDS * c + 2 * b] + weight[2 * SPECTRUM_BANDS * c + 2 * b + 1];
	for (int b = 0; b < SPECTRUM_BANDS; b++)
		for (int c = 0; c < 3; c++) {
			const int c1 = (c + 1) % 3, c2 = (c + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
			bands->from_rgb[b][c] = bands->to_rgb[c1][b1] * bands->to_rgb[c2][b2] -
						bands->to_rgb[c1][b2] * bands->to_rgb[c2][b1];
		}
	for (int c = 0; c < 3; c++)
		determinant += bands->from_rgb[0][c] * bands->to_rgb[c][0];
	for (int b = 0; b < SPECTRUM_BANDS; b++)
		for (int c = 0; c < 3; c++)
			bands->from_rgb[b][c] /= determinant;
	return STATUS_OK;
}
